#include "server/mqtt/client.h"

#include <chrono>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/mqtt/encode.h"
#include "server/mqtt/limits.h"
#include "tests/unit/server/mqtt/client_bench.h"

namespace uplink::mqtt {
namespace {

using namespace std::chrono_literals;
using testing::ClientBench;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::MqttPacket;
using testing::MqttProperties;
using testing::Raw;
using ::testing::SizeIs;

const std::string kPong = Raw("\xD0\0");

TEST(MqttClient, SaysWhoItIsAndWhatItWants) {
  ClientBench bench;
  ASSERT_TRUE(bench.client->SetFilters({{"a/#", Qos::kAtLeastOnce}}).ok());
  bench.client->Start();
  EXPECT_TRUE(bench.link->opened);
  bench.Up();
  EXPECT_EQ(bench.Written(), EncodeConnect({.version = Version::k5,
                                            .client_id = "core",
                                            .clean = false,
                                            .keepalive_seconds = 60,
                                            .session_expiry_seconds = 86'400,
                                            .receive_maximum = 2}));
  bench.link->Bring(bench.AcceptBytes(false));
  const Filter filter{"a/#", Qos::kAtLeastOnce};
  EXPECT_EQ(bench.Written(), EncodeSubscribe(Version::k5, 1, {&filter, 1}));
  EXPECT_EQ(bench.client->status().state, ClientState::kSubscribing);
  bench.link->Bring(Raw("\x90\4\0\1\0\1"));
  EXPECT_EQ(bench.subscribed, 1);
  const ClientStatus status = bench.client->status();
  EXPECT_EQ(status.state, ClientState::kSubscribed);
  EXPECT_EQ(status.connected_since, bench.clock.System());
  EXPECT_EQ(bench.probe.connected.value(), 1);
}

TEST(MqttClient, ReadsNoFurtherPastTheWindowUntilThereIsRoom) {
  ClientBench bench;
  bench.Begin();
  bench.link->Bring(bench.MessageBytes("1", 1) + bench.MessageBytes("2", 2) +
                    bench.MessageBytes("live") + bench.MessageBytes("3", 3) +
                    bench.MessageBytes("behind"));
  EXPECT_THAT(bench.Payloads(), ElementsAre("1", "2", "live"));
  EXPECT_FALSE(bench.link->reading);
  EXPECT_EQ(bench.probe.stopped_by_window.value(), 1);
  EXPECT_EQ(bench.probe.window_stops.value(), 1);
  bench.client->Release(*bench.messages[0].ack);
  EXPECT_THAT(bench.Payloads(), ElementsAre("1", "2", "live", "3", "behind"));
  EXPECT_TRUE(bench.link->reading);
  EXPECT_EQ(bench.probe.stopped_by_window.value(), 0);
}

TEST(MqttClient, AFullWindowAloneStopsNothing) {
  ClientBench bench;
  bench.Begin();
  bench.link->Bring(bench.MessageBytes("1", 1) + bench.MessageBytes("2", 2));
  EXPECT_TRUE(bench.link->reading) << "a broker that obeys sends no third one, but PINGRESP";
  EXPECT_EQ(bench.probe.window_stops.value(), 0);
}

TEST(MqttClient, StopsReadingWhenTheCoreAsksAlsoOverConnections) {
  ClientBench bench;
  bench.on_message = [&] { bench.client->StopReading(); };
  bench.Begin();
  bench.link->Bring(bench.MessageBytes("1") + bench.MessageBytes("2"));
  EXPECT_THAT(bench.Payloads(), ElementsAre("1"));
  EXPECT_FALSE(bench.link->reading);
  bench.client->ReadAgain();
  EXPECT_THAT(bench.Payloads(), ElementsAre("1", "2"));
  EXPECT_FALSE(bench.link->reading);
  bench.link->events()->OnDown({EndReason::kBroken, "broken"});
  bench.Advance(1s);
  bench.Up();
  EXPECT_FALSE(bench.link->reading);
  bench.client->ReadAgain();
  EXPECT_TRUE(bench.link->reading);
}

TEST(MqttClient, ALatePingrespIsNoFailureWhileTheCoreStopsReading) {
  ClientBench bench;
  bench.Begin();
  bench.client->StopReading();
  bench.Advance(300s);
  EXPECT_THAT(bench.ends, SizeIs(0));
  bench.client->ReadAgain();
  bench.link->Bring(kPong);
  bench.Advance(30s);
  EXPECT_THAT(bench.ends, SizeIs(0));
}

TEST(MqttClient, EachStepOfConnectingHasItsLimit) {
  ClientBench bench;
  bench.client->Start();
  bench.Advance(kResolveWait);
  ASSERT_THAT(bench.ends, SizeIs(1));
  EXPECT_THAT(bench.ends[0].text, HasSubstr("not resolved in time"));
  bench.Advance(bench.pauses[0]);
  bench.link->events()->OnPhase(LinkPhase::kConnecting);
  bench.Advance(kConnectWait);
  EXPECT_THAT(bench.ends[1].text, HasSubstr("did not take the connection in time"));
  bench.Advance(bench.pauses[1]);
  bench.link->events()->OnPhase(LinkPhase::kHandshaking);
  bench.Advance(kTlsWait);
  EXPECT_THAT(bench.ends[2].text, HasSubstr("handshake did not end in time"));
  bench.Advance(bench.pauses[2]);
  bench.Up();
  bench.Advance(kAnswerWait - 1s);
  EXPECT_THAT(bench.ends, SizeIs(3));
  bench.Advance(1s);
  EXPECT_THAT(bench.ends[3].text, HasSubstr("no CONNACK"));
  for (const End& end : bench.ends) EXPECT_EQ(end.reason, EndReason::kTimeout);
  EXPECT_EQ(bench.probe.ended[static_cast<std::size_t>(EndReason::kTimeout)].value(), 4);
}

TEST(MqttClient, ASubscriptionWithoutAnAnswerEndsTheConnection) {
  ClientBench bench;
  ASSERT_TRUE(bench.client->SetFilters({{"a"}}).ok());
  bench.Begin();
  bench.Advance(kAnswerWait);
  ASSERT_THAT(bench.ends, SizeIs(1));
  EXPECT_THAT(bench.ends[0].text, HasSubstr("no answer to what we subscribed to"));
}

TEST(MqttClient, ABrokerThatTakesNothingEndsTheConnection) {
  ClientBench bench;
  bench.Begin();
  EXPECT_TRUE(bench.client->Publish({.topic = "p", .payload = "x"}));
  bench.clock.Advance(kWriteWait);
  bench.link->events()->OnDue();
  ASSERT_THAT(bench.ends, SizeIs(1));
  EXPECT_EQ(bench.ends[0].reason, EndReason::kWriteStalled);
}

TEST(MqttClient, PublishesOnlyWhatThereIsRoomForAndCountsTheRest) {
  ClientBench bench;
  EXPECT_FALSE(bench.client->Publish({.topic = "p"})) << "not connected";
  bench.client->Start();
  bench.Up();
  EXPECT_FALSE(bench.client->Publish({.topic = "p"})) << "nor accepted";
  bench.link->Bring(MqttPacket(0x20, Raw("\0\0") + MqttProperties(Raw("\x27\0\0\1\0"))));
  static_cast<void>(bench.Written());
  const Outgoing pong{.topic = "p", .payload = "{}", .correlation = "id"};
  EXPECT_TRUE(bench.client->Publish(pong));
  EXPECT_EQ(bench.Written(), EncodePublish(Version::k5, pong));
  EXPECT_FALSE(bench.client->Publish({.topic = "p", .payload = std::string(256, 'x')}))
      << "the broker said that it takes no such size";
  EXPECT_FALSE(bench.client->Publish({.topic = ""}));
  EXPECT_FALSE(bench.client->Publish({.topic = std::string(70'000, 't')}));
  int sent = 0;
  while (bench.client->Publish({.topic = "p", .payload = std::string(200, 'x')})) ++sent;
  EXPECT_GT(sent, 1000);
  EXPECT_LE(sent, static_cast<int>(kQueueBytesMax / 200));
  EXPECT_EQ(bench.probe.published.value(), sent + 1);
  EXPECT_EQ(bench.probe.publishes_dropped.value(), 6);
}

TEST(MqttClient, ARefusedFilterIsTroubleAndAskedForAgain) {
  ClientBench bench;
  ASSERT_TRUE(bench.client->SetFilters({{"a", Qos::kAtLeastOnce}, {"b", Qos::kAtLeastOnce}}).ok());
  bench.Begin();
  bench.link->Bring(Raw("\x90\5\0\1\0\x87\0"));
  ASSERT_THAT(bench.troubles, SizeIs(2));
  EXPECT_EQ(bench.troubles[0].kind, Trouble::Kind::kFilterRefused);
  EXPECT_EQ(bench.troubles[0].text, "the broker refuses a: not authorized (0x87)");
  EXPECT_EQ(bench.troubles[1].kind, Trouble::Kind::kLowerQos);
  EXPECT_EQ(bench.troubles[1].text, "the broker serves b at QoS 0 only");
  EXPECT_EQ(bench.client->status().filters_refused, 1U);
  EXPECT_EQ(bench.client->status().filters_lower, 1U);
  EXPECT_EQ(bench.probe.refusals.value(), 1);
  EXPECT_EQ(bench.probe.lower_grants.value(), 1);
  EXPECT_EQ(bench.subscribed, 1);
  static_cast<void>(bench.Written());
  bench.Advance(30s);
  bench.link->Bring(kPong);
  bench.Advance(30s);
  const Filter filter{"a", Qos::kAtLeastOnce};
  EXPECT_THAT(bench.Written(), HasSubstr(EncodeSubscribe(Version::k5, 2, {&filter, 1})));
  bench.link->Bring(Raw("\x90\4\0\2\0\1"));
  EXPECT_EQ(bench.client->status().filters_refused, 0U);
  EXPECT_EQ(bench.subscribed, 2);
}

TEST(MqttClient, ALostSessionIsTroubleBeforeAnyMessage) {
  ClientBench bench;
  bench.client->Start();
  bench.Connect(false);
  EXPECT_THAT(bench.troubles, SizeIs(0)) << "there was none before";
  bench.link->events()->OnDown({EndReason::kClosed, ""});
  bench.Advance(1s);
  bench.on_message = [&] { EXPECT_THAT(bench.troubles, SizeIs(1)); };
  bench.Up();
  bench.link->Bring(bench.AcceptBytes(false) + bench.MessageBytes("x"));
  EXPECT_THAT(bench.messages, SizeIs(1));
  EXPECT_EQ(bench.troubles[0].kind, Trouble::Kind::kSessionLost);
  EXPECT_TRUE(bench.connections[1].session_lost);
  EXPECT_EQ(bench.probe.sessions_lost.value(), 1);
  EXPECT_TRUE(bench.client->status().session_lost_at.has_value());
}

TEST(MqttClient, ASessionThatIsExpectedFromBeforeOurStartMayBeLostToo) {
  ClientBench bench([](ClientSettings& settings) { settings.expect_session = true; });
  bench.client->Start();
  bench.Connect(false);
  EXPECT_TRUE(bench.connections[0].session_lost);
}

TEST(MqttClient, ASessionThatIsKeptForLessThanAskedIsTrouble) {
  struct Case {
    std::string properties;
    std::size_t troubles = 0;
  };
  for (const Case& each : std::vector<Case>{
           {Raw("\x11\0\0\x0E\x10"), 1},      // 3600
           {Raw("\x11\0\0\0\0"), 1},          // none at all
           {Raw("\x11\0\1\x51\x80"), 0},      // 86400, as asked
           {Raw("\x11\xFF\xFF\xFF\xFF"), 0},  // for ever
           {"", 0},
       }) {
    ClientBench bench;
    bench.client->Start();
    bench.Up();
    bench.link->Bring(MqttPacket(0x20, Raw("\0\0") + MqttProperties(each.properties)));
    ASSERT_THAT(bench.troubles, SizeIs(each.troubles));
    EXPECT_EQ(bench.probe.sessions_short.value(), static_cast<std::int64_t>(each.troubles));
    if (bench.troubles.empty()) continue;
    EXPECT_EQ(bench.troubles[0].kind, Trouble::Kind::kSessionShort);
    EXPECT_THAT(bench.troubles[0].text, HasSubstr("86400 s of mqtt.session_expiry"));
    EXPECT_EQ(bench.client->status().last_error, bench.troubles[0].text);
  }
}

TEST(MqttClient, ASessionThatWeDoNotWantMayBeShort) {
  ClientBench bench([](ClientSettings& settings) { settings.kept_session = false; });
  bench.client->Start();
  bench.Up();
  bench.link->Bring(MqttPacket(0x20, Raw("\0\0") + MqttProperties(Raw("\x11\0\0\0\0"))));
  EXPECT_THAT(bench.connections, SizeIs(1));
  EXPECT_THAT(bench.troubles, SizeIs(0));
}

TEST(MqttClient, AnIdThatAnotherTookIsWaitedOutForAMinute) {
  ClientBench bench;
  bench.Begin();
  bench.link->Bring(Raw("\xE0\2\x8E\0"));
  ASSERT_THAT(bench.ends, SizeIs(1));
  EXPECT_EQ(bench.ends[0].reason, EndReason::kIdTaken);
  EXPECT_EQ(bench.pauses[0], 60s);
  EXPECT_EQ(bench.troubles.at(0).kind, Trouble::Kind::kIdTaken);
  EXPECT_EQ(bench.client->status().state, ClientState::kIdTaken);
  EXPECT_EQ(bench.probe.ids_taken.value(), 1);
  EXPECT_EQ(bench.probe.id_taken.value(), 1);
  bench.Advance(59s);
  EXPECT_FALSE(bench.link->opened);
  bench.Advance(1s);
  EXPECT_TRUE(bench.link->opened);
  bench.Up();
  EXPECT_EQ(bench.probe.id_taken.value(), 1) << "whether it is free now is the broker's to say";
  bench.link->Bring(bench.AcceptBytes(true));
  EXPECT_EQ(bench.probe.id_taken.value(), 0);
}

TEST(MqttClient, AnIdIsNoLongerTakenOnceNobodyTakesTheConnection) {
  ClientBench bench;
  bench.Begin();
  bench.link->Bring(Raw("\xE0\2\x8E\0"));
  ASSERT_EQ(bench.probe.id_taken.value(), 1);
  bench.Advance(60s);
  ASSERT_TRUE(bench.link->opened);
  bench.link->events()->OnDown({EndReason::kConnect, "no one accepts the connection"});
  EXPECT_EQ(bench.client->status().state, ClientState::kWaiting);
  EXPECT_EQ(bench.probe.id_taken.value(), 0) << "as the state says, and so /readyz";
}

TEST(MqttClient, WhatABrokerMustNotSendEndsTheConnectionByItsName) {
  struct Case {
    std::string bytes;
    EndReason reason;
    /// Our DISCONNECT.
    std::string farewell;
  };
  for (const Case& each : std::vector<Case>{
           {Raw("\x34\6\0\1t\0\1\0"), EndReason::kQos2, Raw("\xE0\1\x9B")},
           {Raw("\x50\2\0\1"), EndReason::kUnexpectedPacket, Raw("\xE0\1\x82")},
           {Raw("\x20\3\0\0\0"), EndReason::kUnexpectedPacket, Raw("\xE0\1\x82")},
           {Raw("\x90\4\0\1\0\0"), EndReason::kUnexpectedAnswer, Raw("\xE0\1\x82")},
           {Raw("\xB0\4\0\1\0\0"), EndReason::kUnexpectedAnswer, Raw("\xE0\1\x82")},
           {Raw("\x30\7\0\1t\3\x23\0\1"), EndReason::kTopicAlias, Raw("\xE0\1\x94")},
           {Raw("\x30\6\0\1t\2\x7F\0"), EndReason::kUnknownProperty, Raw("\xE0\1\x81")},
           {Raw("\x30\3\0\5t"), EndReason::kMalformed, Raw("\xE0\1\x81")},
           {Raw("\xE0\2\x8B\0"), EndReason::kDisconnected, ""},
       }) {
    ClientBench bench;
    bench.client->Start();
    bench.Connect();
    const auto link = bench.link;
    bench.link->Bring(each.bytes);
    ASSERT_THAT(bench.ends, SizeIs(1)) << Name(each.reason);
    EXPECT_EQ(bench.ends[0].reason, each.reason) << bench.ends[0].text;
    EXPECT_EQ(link->farewell, each.farewell);
    EXPECT_FALSE(bench.client->status().last_error.empty());
    EXPECT_EQ(bench.probe.connected.value(), 0);
  }
}

TEST(MqttClient, ARefusalAndAPacketBeforeConnackEndTheConnection) {
  ClientBench bench;
  bench.client->Start();
  bench.Up();
  bench.link->Bring(MqttPacket(0x20, Raw("\0\x87") + MqttProperties(Raw("\x1F\0\2no"))));
  ASSERT_THAT(bench.ends, SizeIs(1));
  EXPECT_EQ(bench.ends[0].reason, EndReason::kRefused);
  EXPECT_EQ(bench.client->status().last_error, "the broker refuses: not authorized (0x87): no");
  bench.Advance(bench.pauses[0]);
  bench.Up();
  bench.link->Bring(bench.MessageBytes("x"));
  ASSERT_THAT(bench.ends, SizeIs(2));
  EXPECT_EQ(bench.ends[1].reason, EndReason::kUnexpectedPacket);
}

TEST(MqttClient, ABrokerThatHas311AloneIsToldOf) {
  ClientBench bench;
  bench.client->Start();
  bench.Up();
  bench.link->Bring(MqttPacket(0x20, Raw("\0\1")));
  ASSERT_THAT(bench.ends, SizeIs(1));
  EXPECT_EQ(bench.ends[0].reason, EndReason::kRefused);
  EXPECT_EQ(bench.client->status().last_error,
            "the broker refuses: unacceptable protocol version (0x01): it answers by MQTT 3.1.1: "
            "set mqtt.version = \"3.1.1\" for a broker without 5");
}

TEST(MqttClient, ASessionThatGoesOnThoughWeAskedForNoneEndsTheConnection) {
  ClientBench bench([](ClientSettings& settings) { settings.kept_session = false; });
  bench.client->Start();
  bench.Up();
  bench.link->Bring(bench.AcceptBytes(true));
  ASSERT_THAT(bench.ends, SizeIs(1));
  EXPECT_EQ(bench.ends[0].reason, EndReason::kUnexpectedAnswer);
}

TEST(MqttClient, StopSaysWhatWaitsAndFarewellAndComesBackNoMore) {
  ClientBench bench;
  bench.Begin();
  const auto link = bench.link;
  bench.link->Bring(bench.MessageBytes("x", 5) + bench.MessageBytes("y", 6));
  bench.client->Release(*bench.messages[0].ack);  // is being written
  bench.client->Release(*bench.messages[1].ack);
  bench.client->Stop();
  EXPECT_TRUE(link->closed);
  EXPECT_EQ(link->farewell, EncodePuback(6) + Raw("\xE0\0"));
  EXPECT_EQ(bench.client->status().state, ClientState::kStopped);
  EXPECT_THAT(bench.ends, SizeIs(0));
}

TEST(MqttClient, StopWithinTheCallTellsNoFurtherMessage) {
  ClientBench bench;
  bench.on_message = [&] { bench.client->Stop(); };
  bench.Begin();
  const auto link = bench.link;
  bench.link->Bring(bench.MessageBytes("1") + bench.MessageBytes("2"));
  EXPECT_THAT(bench.Payloads(), ElementsAre("1"));
  EXPECT_TRUE(link->closed);
}

TEST(MqttClient, StopWithinTheEndOfAConnectionStops) {
  ClientBench bench;
  bench.on_ended = [&] { bench.client->Stop(); };
  bench.client->Start();
  bench.link->events()->OnDown({EndReason::kConnect, "refused"});
  EXPECT_TRUE(bench.link->closed);
  EXPECT_EQ(bench.client->status().state, ClientState::kStopped);
}

TEST(MqttClient, APasswordThatCannotBeReadIsTriedAgainLater) {
  ClientBench bench([](ClientSettings& settings) {
    settings.username = "me";
    settings.password_file = "/nonexistent/password";
  });
  bench.client->Start();
  ASSERT_THAT(bench.ends, SizeIs(1));
  EXPECT_EQ(bench.ends[0].reason, EndReason::kSettings);
  EXPECT_THAT(bench.ends[0].text, HasSubstr("mqtt.password_file: /nonexistent/password"));
  bench.Advance(bench.pauses[0]);
  EXPECT_THAT(bench.ends, SizeIs(2));
}

TEST(MqttClient, FiltersThatChangeAreAskedForAtOnce) {
  ClientBench bench;
  bench.Begin();
  EXPECT_EQ(bench.subscribed, 1);
  ASSERT_TRUE(bench.client->SetFilters({{"a"}}, {"old"}).ok());
  const std::vector<std::string> old = {"old"};
  EXPECT_EQ(bench.Written(), EncodeUnsubscribe(Version::k5, 1, old));
  bench.link->Bring(Raw("\xB0\4\0\1\0\x11"));
  const Filter filter{"a"};
  EXPECT_EQ(bench.Written(), EncodeSubscribe(Version::k5, 2, {&filter, 1}));
  bench.link->Bring(Raw("\x90\4\0\2\0\0"));
  EXPECT_EQ(bench.subscribed, 2);
  EXPECT_FALSE(bench.client->SetFilters({{"a#"}}).ok());
}

}  // namespace
}  // namespace uplink::mqtt
