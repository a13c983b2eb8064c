// What no mosquitto sends, over real sockets. Each rule has its table in tests/unit/server/mqtt;
// here the link and its timers are seen to follow them.
#include <chrono>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/mqtt/encode.h"
#include "tests/component/mqtt/client_world.h"
#include "tests/component/mqtt/scripted_broker.h"
#include "tests/support/mqtt_bytes.h"

namespace uplink::mqtt {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using testing::LoopbackSettings;
using testing::MqttWorld;
using testing::PublishBytes;
using testing::Raw;
using testing::ScriptedBroker;
using ::testing::SizeIs;
using testing::WorldClient;

const std::string kPing = Raw("\xC0\0");
const std::string kPong = Raw("\xD0\0");
const std::string kAccept311 = Raw("\x20\2\0\0");
const std::string kAccept5 = Raw("\x20\3\0\0\0");
/// With a Server Keep Alive of a second.
const std::string kAcceptHasty = Raw("\x20\6\0\0\3\x13\0\1");

std::string Message(std::string payload, std::size_t id, bool dup = false, bool mqtt5 = true) {
  return PublishBytes{.payload = std::move(payload), .id = id, .dup = dup, .mqtt5 = mqtt5}.Text();
}

class MqttScripted : public ::testing::Test {
 protected:
  ClientSettings Settings(Version version = Version::k5) {
    ClientSettings settings = LoopbackSettings(broker_.port(), version);
    settings.waits.ping = 300ms;
    return settings;
  }
  /// Waits for the connection of this number, and its CONNECT.
  [[nodiscard]] bool UntilConnected(std::size_t number) {
    return world_.Until([&] { return broker_.Poll() >= number && !broker_.received().empty(); });
  }
  [[nodiscard]] bool UntilReceived(const std::string& end) {
    return world_.Until([&] { return broker_.received().ends_with(end); });
  }

  void SendByteByByte(const std::string& bytes) {
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      broker_.Send(bytes.substr(i, 1));
      // So that bytes come alone: what the client has read it asks for no more.
      static_cast<void>(world_.Until([] { return false; }, 1ms));
    }
  }

  MqttWorld world_;
  ScriptedBroker broker_;
};

TEST_F(MqttScripted, PacketsCutAtEachByteAreTheSame) {
  for (const Version version : {Version::k311, Version::k5}) {
    const bool mqtt5 = version == Version::k5;
    WorldClient client(world_, Settings(version));
    ASSERT_TRUE(client->SetFilters({{"t", Qos::kAtLeastOnce}}).ok());
    const std::size_t before = broker_.Poll();
    client->Start();
    ASSERT_TRUE(UntilConnected(before + 1));
    const std::string all = (mqtt5 ? Raw("\x90\4\0\1\0\1") : Raw("\x90\3\0\1\1")) +
                            Message("first", 1, false, mqtt5) + Message("", 0, false, mqtt5) +
                            Message(std::string(300, 'x'), 2, false, mqtt5);
    SendByteByByte(mqtt5 ? kAccept5 : kAccept311);
    // What answers a SUBSCRIBE comes after it.
    ASSERT_TRUE(world_.Until([&] { return client.connections.size() == 1; }));
    SendByteByByte(all);
    ASSERT_TRUE(client.UntilMessages(3));
    EXPECT_EQ(client.subscribed, 1);
    EXPECT_THAT(client.Payloads(), ElementsAre("first", "", std::string(300, 'x')));
    EXPECT_THAT(client.ends, SizeIs(0));
    client->Release(*client.messages[0].ack);
    client->Release(*client.messages[2].ack);
    EXPECT_TRUE(UntilReceived(EncodePuback(1) + EncodePuback(2)));
  }
}

TEST_F(MqttScripted, AConnectionThatEndsWithinAPacketIsMadeAnew) {
  WorldClient client(world_, Settings());
  client->Start();
  ASSERT_TRUE(UntilConnected(1));
  broker_.Send(kAccept5 + Message("whole", 1) + Message("half", 2).substr(0, 5));
  ASSERT_TRUE(client.UntilMessages(1));
  broker_.Hang();
  ASSERT_TRUE(client.UntilEnds(1));
  EXPECT_EQ(client.ends[0].reason, EndReason::kClosed);
  ASSERT_TRUE(UntilConnected(2));
  broker_.Send(kAccept5 + Message("whole", 1, true));
  ASSERT_TRUE(client.UntilMessages(2));
  EXPECT_TRUE(client.messages[1].dup);
  EXPECT_FALSE(client.messages[1].again) << "it is another connection";
  // What the first connection delivered is acked by none.
  client->Release(*client.messages[0].ack);
  client->Release(*client.messages[1].ack);
  ASSERT_TRUE(UntilReceived(EncodePuback(1)));
  EXPECT_EQ(client.probe.pubacks.value(), 1);
}

TEST_F(MqttScripted, WhatEndsAConnectionSaysSoToTheBrokerAndComesBack) {
  WorldClient client(world_, Settings());
  client->Start();
  ASSERT_TRUE(UntilConnected(1));
  broker_.Send(kAccept5 + Raw("\x34\6\0\1t\0\1\0"));  // QoS 2
  ASSERT_TRUE(client.UntilEnds(1));
  EXPECT_EQ(client.ends[0].reason, EndReason::kQos2);
  ASSERT_TRUE(UntilReceived(Raw("\xE0\1\x9B")));
  EXPECT_TRUE(UntilConnected(2));
}

TEST_F(MqttScripted, ARedeliveryByTimerIsAckedOnce) {
  WorldClient client(world_, Settings());
  client->Start();
  ASSERT_TRUE(UntilConnected(1));
  broker_.Send(kAccept5 + Message("x", 9) + Message("x", 9, true) + Message("y", 10));
  ASSERT_TRUE(client.UntilMessages(3));
  EXPECT_TRUE(client.messages[1].again);
  client->Release(*client.messages[1].ack);
  client->Release(*client.messages[0].ack);
  client->Release(*client.messages[2].ack);
  ASSERT_TRUE(UntilReceived(EncodePuback(10)));
  EXPECT_THAT(broker_.received(), EndsWith(EncodePuback(9) + EncodePuback(10)));
  EXPECT_EQ(client.probe.pubacks.value(), 2);
  EXPECT_EQ(client.probe.redelivered.value(), 1);
}

TEST_F(MqttScripted, ABlackHoleIsNoticed) {
  WorldClient client(world_, Settings());
  client->Start();
  ASSERT_TRUE(UntilConnected(1));
  broker_.Send(kAcceptHasty);
  ASSERT_TRUE(UntilReceived(kPing));
  ASSERT_TRUE(client.UntilEnds(1));
  EXPECT_EQ(client.ends[0].reason, EndReason::kPingLate);
  EXPECT_TRUE(UntilConnected(2));
}

TEST_F(MqttScripted, ALatePingrespIsNoFailureWhileTheWindowIsFull) {
  ClientSettings settings = Settings();
  settings.unacked_max = 1;
  WorldClient client(world_, settings);
  client->Start();
  ASSERT_TRUE(UntilConnected(1));
  broker_.Send(kAcceptHasty + Message("1", 1) + Message("2", 2));
  ASSERT_TRUE(client.UntilMessages(1));
  ASSERT_TRUE(UntilReceived(kPing + kPing)) << "a second, which is past three waits for the first";
  EXPECT_THAT(client.ends, SizeIs(0));
  EXPECT_THAT(client.messages, SizeIs(1));
  broker_.Send(kPong + kPong);
  client->Release(*client.messages[0].ack);
  ASSERT_TRUE(client.UntilMessages(2));
  ASSERT_TRUE(UntilReceived(EncodePuback(1)));
  ASSERT_TRUE(UntilReceived(kPing));
  broker_.Send(kPong);
  EXPECT_THAT(client.ends, SizeIs(0));
}

TEST_F(MqttScripted, AListenerThatSaysNothingIsLeft) {
  ClientSettings settings = Settings();
  settings.waits.answer = 100ms;
  settings.waits.tls = 100ms;
  WorldClient plain(world_, settings);
  plain->Start();
  ASSERT_TRUE(plain.UntilEnds(1));
  EXPECT_EQ(plain.ends[0].reason, EndReason::kTimeout);
  EXPECT_THAT(plain.ends[0].text, HasSubstr("CONNACK"));
  plain->Stop();
  settings.url.tls = true;
  WorldClient secure(world_, settings);
  secure->Start();
  ASSERT_TRUE(secure.UntilEnds(1));
  EXPECT_EQ(secure.ends[0].reason, EndReason::kTimeout);
  EXPECT_THAT(secure.ends[0].text, HasSubstr("handshake"));
}

TEST_F(MqttScripted, AnAddressWhereNobodyListensIsToldAndTriedAgain) {
  ClientSettings settings = Settings();
  {
    const ScriptedBroker gone;
    settings.url.port = gone.port();
  }
  WorldClient client(world_, settings);
  client->Start();
  ASSERT_TRUE(client.UntilEnds(3));
  for (const End& end : client.ends) EXPECT_EQ(end.reason, EndReason::kConnect) << end.text;
  EXPECT_EQ(client->status().state, ClientState::kWaiting);
  EXPECT_THAT(client->status().last_error, HasSubstr("no one accepts the connection"));
}

TEST_F(MqttScripted, ANameIsResolvedAndStopSaysFarewell) {
  ClientSettings settings = Settings();
  settings.url.host = "localhost";
  WorldClient client(world_, settings);
  client->Start();
  ASSERT_TRUE(UntilConnected(1));
  broker_.Send(kAccept5);
  ASSERT_TRUE(world_.Until([&] { return client.connections.size() == 1; }));
  client->Stop();
  ASSERT_TRUE(UntilReceived(Raw("\xE0\0")));
  EXPECT_TRUE(world_.Until([&] { return broker_.ended(); }));
}

TEST_F(MqttScripted, AnIdThatIsTakenWithoutAWordIsKnownByThreeShortConnections) {
  WorldClient client(world_, Settings(Version::k311));
  client->Start();
  for (std::size_t number = 1; number <= 3; ++number) {
    ASSERT_TRUE(UntilConnected(number));
    broker_.Send(kAccept311);
    ASSERT_TRUE(world_.Until([&] { return client.connections.size() == number; }));
    EXPECT_THAT(client.troubles.size(), ::testing::Le(number - 1)) << "sessions that were lost";
    broker_.Hang();
    ASSERT_TRUE(client.UntilEnds(number));
  }
  EXPECT_EQ(client.troubles.back().kind, Trouble::Kind::kIdTaken);
  EXPECT_GE(client.pauses.back(), 60s);
  EXPECT_EQ(client->status().state, ClientState::kIdTaken);
}

TEST_F(MqttScripted, AClientThatGoesWhileSomethingIsUnderWayLeavesNothingBehind) {
  for (int step = 0; step < 4; ++step) {
    WorldClient client(world_, Settings());
    const std::size_t before = broker_.Poll();
    client->Start();
    if (step == 0) continue;
    ASSERT_TRUE(UntilConnected(before + 1));
    if (step == 1) continue;
    broker_.Send(kAccept5);
    ASSERT_TRUE(world_.Until([&] { return client.connections.size() == 1; }));
    if (step == 2) continue;
    broker_.Hang();
    ASSERT_TRUE(client.UntilEnds(1));
  }
  // Handlers of what is gone run now.
  static_cast<void>(world_.Until([] { return false; }, 20ms));
}

}  // namespace
}  // namespace uplink::mqtt
