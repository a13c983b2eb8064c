// The client against a real broker.
#include "tests/support/mosquitto.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/identity/certificate_gate.h"
#include "tests/component/mqtt/client_world.h"
#include "tests/support/certificates.h"
#include "tests/support/mqtt_bytes.h"
#include "tests/support/mqtt_publisher.h"
#include "tests/support/temp_folder.h"

namespace uplink::mqtt {
namespace {

using namespace std::chrono_literals;
using testing::ClientMessage;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::LoopbackSettings;
using testing::Mosquitto;
using testing::MosquittoOptions;
using testing::MqttPublisher;
using testing::MqttWorld;
using ::testing::SizeIs;
using testing::WorldClient;

std::vector<std::string> Numbered(int count) {
  std::vector<std::string> texts;
  texts.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) texts.push_back(std::to_string(i));
  return texts;
}

void PublishNumbered(MqttPublisher& publisher, int count) {
  for (const std::string& each : Numbered(count)) publisher.Publish("d/x", each);
}

class MqttMosquitto : public ::testing::TestWithParam<Version> {
 protected:
  void StartBroker(const MosquittoOptions& options = {}) { broker_.emplace(options); }
  [[nodiscard]] ClientSettings Settings() const {
    return LoopbackSettings(broker_->port(), GetParam());
  }

  [[nodiscard]] bool UntilLogged(const std::string& part) {
    return world_.Until([&] { return broker_->Logged(part); });
  }

  MqttWorld world_;
  std::optional<Mosquitto> broker_;
};

const std::vector<Filter> kDurable = {{"d/#", Qos::kAtLeastOnce}};

TEST_P(MqttMosquitto, GivesMessagesOfBothKindsAndTheBrokerTakesItsAcks) {
  StartBroker();
  WorldClient client(world_, Settings());
  ASSERT_TRUE(client.Subscribe({{"d/#", Qos::kAtLeastOnce}, {"l/#", Qos::kAtMostOnce}}));
  EXPECT_FALSE(client.connections[0].session_present);
  MqttPublisher publisher(broker_->port());
  publisher.Publish("d/one", "1");
  publisher.PublishLive("l/two", "2");
  publisher.Publish("l/three", std::string(800'000, 'x'));
  ASSERT_TRUE(client.UntilMessages(3));
  EXPECT_EQ(client.messages[0].topic, "d/one");
  ASSERT_TRUE(client.messages[0].ack);
  EXPECT_FALSE(client.messages[1].ack) << "asked for at QoS 0";
  EXPECT_FALSE(client.messages[2].read);
  EXPECT_EQ(client.messages[2].bytes, 800'000U);
  client->Release(*client.messages[0].ack);
  EXPECT_TRUE(UntilLogged("Received PUBACK from core"));
}

TEST_P(MqttMosquitto, WhatAPublisherMakesUpEndsNothingAndDoesNotComeAgain) {
  StartBroker();
  WorldClient client(world_, Settings());
  ASSERT_TRUE(client.Subscribe(kDurable));
  MqttPublisher publisher(broker_->port(), MqttPublisher::Mqtt5{});
  std::string large;
  for (int i = 0; i < 4; ++i) {
    large += "\x26" + testing::MqttField("k") + testing::MqttField(std::string(60'000, 'v'));
  }
  publisher.PublishWith(testing::Raw("\1\2"), "d/format", "1");  // 0 and 1 are the formats
  publisher.PublishWith(large, "d/large", "2");
  publisher.PublishWith({}, "d/good", "3");
  ASSERT_TRUE(client.UntilMessages(3));
  const bool mqtt5 = GetParam() == Version::k5;
  EXPECT_THAT(client.Payloads(), ElementsAre("1", mqtt5 ? "" : "2", "3"));
  EXPECT_EQ(client.messages[1].topic, "d/large");
  EXPECT_EQ(client.messages[1].read, !mqtt5) << "3.1.1 has no properties";
  for (const ClientMessage& each : client.messages) client->Release(*each.ack);
  EXPECT_TRUE(UntilLogged("Received PUBACK from core (Mid: 3"));
  EXPECT_THAT(client.ends, SizeIs(0));
}

TEST_P(MqttMosquitto, WhatIsUnackedComesAgainAfterAKillAndWhatWasAckedDoesNot) {
  StartBroker();
  MqttPublisher publisher(broker_->port());
  {
    WorldClient killed(world_, Settings());
    ASSERT_TRUE(killed.Subscribe(kDurable));
    PublishNumbered(publisher, 5);
    ASSERT_TRUE(killed.UntilMessages(5));
    killed->Release(*killed.messages[0].ack);
    killed->Release(*killed.messages[1].ack);
    killed->Release(*killed.messages[3].ack);  // waits for 2
    ASSERT_TRUE(UntilLogged("Received PUBACK from core (Mid: 2"));
    EXPECT_EQ(killed.probe.pubacks.value(), 2);
    killed.Kill();
    ASSERT_TRUE(UntilLogged("Client core closed its connection"));
  }
  publisher.Publish("d/x", "while away");
  WorldClient client(world_, Settings());
  ASSERT_TRUE(client.Subscribe(kDurable));
  EXPECT_TRUE(client.connections[0].session_present);
  ASSERT_TRUE(client.UntilMessages(4));
  EXPECT_THAT(client.Payloads(), ElementsAre("2", "3", "4", "while away"));
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(client.messages[static_cast<std::size_t>(i)].dup);
  EXPECT_FALSE(client.messages[3].dup);
}

TEST_P(MqttMosquitto, EachWindowTakesABacklogInOrderAndNeverMore) {
  StartBroker();
  for (const std::size_t window : {std::size_t{1}, std::size_t{20}}) {
    ClientSettings settings = Settings();
    settings.client_id = "window-" + std::to_string(window);
    settings.unacked_max = window;
    constexpr int kMessages = 60;
    {
      WorldClient first(world_, settings);
      ASSERT_TRUE(first.Subscribe(kDurable));
    }
    MqttPublisher publisher(broker_->port());
    PublishNumbered(publisher, kMessages);
    WorldClient client(world_, settings);
    std::size_t unacked_max = 0;
    client.on_message = [&](const ClientMessage&) {
      unacked_max = std::max(unacked_max, client->status().unacked);
    };
    ASSERT_TRUE(client->SetFilters(kDurable).ok());
    client->Start();
    for (std::size_t done = 0; done < kMessages; ++done) {
      ASSERT_TRUE(client.UntilMessages(std::min<std::size_t>(done + window, kMessages)))
          << done << " of window " << window;
      client->Release(*client.messages[done].ack);
    }
    EXPECT_EQ(client.Payloads(), Numbered(kMessages));
    EXPECT_EQ(unacked_max, window);
    EXPECT_THAT(client.ends, SizeIs(0));
  }
}

TEST_P(MqttMosquitto, ABrokerThatRestartsHasTheSessionAndWhatCameMeanwhile) {
  StartBroker();
  WorldClient client(world_, Settings());
  ASSERT_TRUE(client.Subscribe(kDurable));
  MqttPublisher(broker_->port()).Publish("d/x", "before");
  ASSERT_TRUE(client.UntilMessages(1));
  broker_->Stop();
  ASSERT_TRUE(client.UntilEnds(1));
  EXPECT_FALSE(client->status().connected_since);
  broker_->Start();
  ASSERT_TRUE(world_.Until([&] { return client.connections.size() == 2; }));
  EXPECT_TRUE(client.connections[1].session_present);
  EXPECT_FALSE(client.connections[1].session_lost);
  ASSERT_TRUE(client.UntilMessages(2));
  EXPECT_EQ(client.messages[1].payload, "before");
  EXPECT_TRUE(client.messages[1].dup);
  ASSERT_TRUE(client.UntilSubscribed(2));
  MqttPublisher(broker_->port()).Publish("d/x", "after");
  ASSERT_TRUE(client.UntilMessages(3)) << "the session's filters were not asked for again";
  EXPECT_THAT(client.troubles, SizeIs(0));
}

TEST_P(MqttMosquitto, ASessionThatTheBrokerLostIsToldAndSubscribedAnew) {
  StartBroker({.lines = "persistence false\n"});
  WorldClient client(world_, Settings());
  ASSERT_TRUE(client.Subscribe(kDurable));
  broker_->Stop();
  broker_->Start();
  ASSERT_TRUE(client.UntilSubscribed(2));
  ASSERT_THAT(client.troubles, SizeIs(1));
  EXPECT_EQ(client.troubles[0].kind, Trouble::Kind::kSessionLost);
  MqttPublisher(broker_->port()).Publish("d/x", "after");
  EXPECT_TRUE(client.UntilMessages(1));
}

TEST_P(MqttMosquitto, ThePasswordIsReadAtEachConnection) {
  StartBroker({.users = {{"core", "right"}}});
  const testing::TempFolder folder;
  ClientSettings settings = Settings();
  settings.username = "core";
  settings.password_file = folder.File("password");
  const auto write = [&](const std::string& password) {
    std::ofstream(settings.password_file) << password << "\n";
    std::filesystem::permissions(settings.password_file, std::filesystem::perms::owner_read |
                                                             std::filesystem::perms::owner_write);
  };
  write("wrong");
  WorldClient client(world_, settings);
  ASSERT_TRUE(client->SetFilters(kDurable).ok());
  client->Start();
  ASSERT_TRUE(client.UntilEnds(2));
  EXPECT_EQ(client.ends[0].reason, EndReason::kRefused);
  EXPECT_THAT(client->status().last_error, HasSubstr("not authorized"));
  write("right");
  EXPECT_TRUE(client.UntilSubscribed(1));
}

TEST_P(MqttMosquitto, AnAclHidesWhatItDoesNotAllow) {
  // mosquitto's own ACL refuses no SUBSCRIBE: what is not allowed just does not come.
  StartBroker({.users = {{"core", "c"}, {"robot", "r"}},
               .acl = "user core\ntopic read d/allowed\nuser robot\ntopic readwrite #\n"});
  const testing::TempFolder folder;
  ClientSettings settings = Settings();
  settings.username = "core";
  settings.password_file = folder.File("password");
  std::ofstream(settings.password_file) << "c";
  std::filesystem::permissions(settings.password_file, std::filesystem::perms::owner_read);
  WorldClient client(world_, settings);
  ASSERT_TRUE(client.Subscribe(kDurable));
  MqttPublisher publisher(broker_->port(), {}, "robot", "r");
  publisher.Publish("d/hidden", "1");
  publisher.Publish("d/allowed", "2");
  ASSERT_TRUE(client.UntilMessages(1));
  EXPECT_EQ(client.messages[0].topic, "d/allowed");
}

TEST_P(MqttMosquitto, ARefusedFilterIsToldAndTheOthersAreServed) {
  const testing::TempFolder folder;
  std::ofstream(folder.File("rules.json")) << R"({"defaultACLAccess": {"publishClientSend": true,
    "publishClientReceive": true, "subscribe": false, "unsubscribe": true},
    "groups": [{"groupname": "all", "roles": [{"rolename": "some"}]}], "anonymousGroup": "all",
    "roles": [{"rolename": "some",
               "acls": [{"acltype": "subscribePattern", "topic": "d/#", "allow": true}]}]})";
  StartBroker({.lines = "plugin " + Mosquitto::SecurityPlugin() + "\nplugin_opt_config_file " +
                        folder.File("rules.json") + "\n"});
  WorldClient client(world_, Settings());
  ASSERT_TRUE(client.Subscribe({{"d/#", Qos::kAtLeastOnce}, {"x/#", Qos::kAtLeastOnce}}));
  ASSERT_THAT(client.troubles, SizeIs(1));
  EXPECT_EQ(client.troubles[0].kind, Trouble::Kind::kFilterRefused);
  EXPECT_THAT(client.troubles[0].text, HasSubstr("x/#"));
  EXPECT_EQ(client->status().filters_refused, 1U);
  MqttPublisher(broker_->port()).Publish("d/x", "served");
  EXPECT_TRUE(client.UntilMessages(1));
}

TEST_P(MqttMosquitto, ALowerQosThanAskedForIsTold) {
  StartBroker({.lines = "max_qos 0\n"});
  WorldClient client(world_, Settings());
  ASSERT_TRUE(client.Subscribe(kDurable));
  ASSERT_THAT(client.troubles, SizeIs(1));
  EXPECT_EQ(client.troubles[0].kind, Trouble::Kind::kLowerQos);
  EXPECT_EQ(client->status().filters_lower, 1U);
}

TEST_P(MqttMosquitto, TwoThatShareAnIdNoticeItAndOneStays) {
  StartBroker();
  WorldClient one(world_, Settings());
  WorldClient other(world_, Settings());
  ASSERT_TRUE(one.Subscribe(kDurable));
  ASSERT_TRUE(other->SetFilters(kDurable).ok());
  other->Start();
  const auto taken = [](WorldClient& client) {
    return client->status().state == ClientState::kIdTaken;
  };
  ASSERT_TRUE(world_.Until([&] { return taken(one) || taken(other); }));
  WorldClient& stays = taken(one) ? other : one;
  ASSERT_TRUE(world_.Until([&] { return stays->status().state == ClientState::kSubscribed; }));
  WorldClient& left = taken(one) ? one : other;
  EXPECT_GE(left.pauses.back(), 60s);
  EXPECT_EQ(left.troubles.back().kind, Trouble::Kind::kIdTaken);
  EXPECT_EQ(left.probe.ids_taken.value(), 1);
}

TEST_P(MqttMosquitto, APrefixThatWasRemovedIsUnsubscribed) {
  StartBroker();
  {
    WorldClient before(world_, Settings());
    ASSERT_TRUE(before.Subscribe({{"d/#", Qos::kAtLeastOnce}, {"old/#", Qos::kAtLeastOnce}}));
  }
  WorldClient client(world_, Settings());
  ASSERT_TRUE(client->SetFilters(kDurable, {"old/#"}).ok());
  client->Start();
  ASSERT_TRUE(client.UntilSubscribed(1));
  MqttPublisher publisher(broker_->port());
  publisher.Publish("old/x", "1");
  publisher.Publish("d/x", "2");
  ASSERT_TRUE(client.UntilMessages(1));
  EXPECT_EQ(client.messages[0].payload, "2");
}

TEST_P(MqttMosquitto, PublishesToOthersWithCorrelationDataWhereThereIsAny) {
  StartBroker();
  ClientSettings settings = Settings();
  settings.kept_session = false;
  WorldClient client(world_, settings);
  ASSERT_TRUE(client.Subscribe({{"pong/#", Qos::kAtMostOnce}}));
  EXPECT_TRUE(client->Publish({.topic = "pong/x", .payload = "{}", .correlation = "id"}));
  ASSERT_TRUE(client.UntilMessages(1));
  EXPECT_EQ(client.messages[0].payload, "{}");
  EXPECT_FALSE(client.messages[0].retained);
  EXPECT_EQ(client.messages[0].correlation, GetParam() == Version::k5 ? "id" : "");
}

/// Over TLS, with a broker whose certificate is for 127.0.0.1 and localhost unless told otherwise.
class MqttTls : public MqttMosquitto {
 protected:
  MqttTls() : authority_("broker authority"), clients_("client authority") {}

  void StartTls(testing::CertificateSpec spec, const std::string& client_ca = {}) {
    spec.key_usages = {"serverAuth"};
    const testing::KeyPair pair = authority_.Issue(spec);
    StartBroker({.certificate = pair.certificate, .key = pair.key, .client_ca = client_ca});
  }
  std::string File(const std::string& name, const std::string& text) {
    std::ofstream(folder_.File(name)) << text;
    std::filesystem::permissions(folder_.File(name), std::filesystem::perms::owner_read);
    return folder_.File(name);
  }
  [[nodiscard]] ClientSettings TlsSettings(const std::string& ca) {
    ClientSettings settings = Settings();
    settings.url.tls = true;
    settings.ca_file = File("ca", ca);
    return settings;
  }
  /// Why it does not get in.
  [[nodiscard]] End FirstEnd(const ClientSettings& settings) {
    WorldClient client(world_, settings);
    client->Start();
    return client.UntilEnds(1) ? client.ends[0] : End{};
  }

  const testing::TempFolder folder_;
  testing::TestAuthority authority_;
  testing::TestAuthority clients_;
};

TEST_P(MqttTls, ABrokerThatProvesWhoItIsIsTakenByAddressAndByName) {
  StartTls(testing::ServerSpec());
  for (const std::string host : {"127.0.0.1", "localhost"}) {
    ClientSettings settings = TlsSettings(authority_.certificate());
    std::filesystem::remove(folder_.File("ca"));
    settings.ca_file = File("ca-" + host, authority_.certificate());
    settings.url.host = host;
    WorldClient client(world_, settings);
    EXPECT_TRUE(client.Subscribe(kDurable)) << host;
  }
}

TEST_P(MqttTls, ABrokerOfAnotherAuthorityIsNone) {
  StartTls(testing::ServerSpec());
  const End end = FirstEnd(TlsSettings(clients_.certificate()));
  EXPECT_EQ(end.reason, EndReason::kTls);
  EXPECT_THAT(end.text, HasSubstr("local issuer certificate"));
}

TEST_P(MqttTls, CertificatesThatTheGateRefusesAreNotRead) {
  const testing::KeyPair pair = [this] {
    testing::CertificateSpec spec = testing::ServerSpec();
    spec.key_usages = {"serverAuth"};
    return authority_.Issue(spec);
  }();
  // OpenSSL does not read a message of more than 32 KiB, so its flaw is reported by its size.
  for (const auto& [more, flaw] : {std::pair(10, identity::CertificateFlaw::kCount),
                                   std::pair(100, identity::CertificateFlaw::kBytes)}) {
    std::string chain = pair.certificate;
    for (int i = 0; i < more; ++i) chain += authority_.certificate();
    StartBroker({.certificate = chain, .key = pair.key});
    const End end = FirstEnd(TlsSettings(authority_.certificate()));
    EXPECT_EQ(end.reason, EndReason::kTls);
    EXPECT_THAT(end.text, HasSubstr("the broker's certificates are refused: " +
                                    std::string(identity::TextOf(flaw))));
  }
}

TEST_P(MqttTls, ASystemWithoutTheAuthorityTrustsNobody) {
  StartTls(testing::ServerSpec());
  ClientSettings settings = TlsSettings("");
  settings.ca_file.clear();
  EXPECT_EQ(FirstEnd(settings).reason, EndReason::kTls);
}

TEST_P(MqttTls, ABrokerWithAnothersNameIsNone) {
  testing::CertificateSpec spec = testing::ServerSpec();
  spec.dns_names = {"other.example"};
  spec.ip_addresses = {"127.0.0.2"};
  StartTls(spec);
  ClientSettings settings = TlsSettings(authority_.certificate());
  EXPECT_THAT(FirstEnd(settings).text, HasSubstr("IP address mismatch"));
  settings.url.host = "localhost";
  EXPECT_THAT(FirstEnd(settings).text, HasSubstr("hostname mismatch"));
}

TEST_P(MqttTls, AClientCertificateIsShownWhereThereIsOne) {
  StartTls(testing::ServerSpec(), clients_.certificate());
  ClientSettings settings = TlsSettings(authority_.certificate());
  const End end = FirstEnd(settings);
  // By TLS 1.3 the client learns after its handshake that it lacks one.
  EXPECT_TRUE(end.reason == EndReason::kTls || end.reason == EndReason::kBroken ||
              end.reason == EndReason::kClosed)
      << end.text;
  const testing::KeyPair pair = clients_.Issue({.common_names = {"core"}});
  settings.certificate_file = File("certificate", pair.certificate);
  settings.key_file = File("key", pair.key);
  WorldClient client(world_, settings);
  EXPECT_TRUE(client.Subscribe(kDurable));
}

TEST_P(MqttTls, FilesThatDoNotFitAreNamed) {
  StartTls(testing::ServerSpec());
  EXPECT_THAT(FirstEnd(TlsSettings("no PEM")).text, HasSubstr("mqtt.ca_file"));
  std::filesystem::remove(folder_.File("ca"));
  ClientSettings settings = TlsSettings(authority_.certificate());
  const testing::KeyPair pair = clients_.Issue({.common_names = {"core"}});
  const testing::KeyPair other = clients_.Issue({.common_names = {"other"}});
  settings.certificate_file = File("certificate", pair.certificate);
  settings.key_file = File("key", other.key);
  const End end = FirstEnd(settings);
  EXPECT_EQ(end.reason, EndReason::kSettings);
  EXPECT_THAT(end.text, HasSubstr("mqtt.client_key_file"));
}

std::string NameOf(const ::testing::TestParamInfo<Version>& one) {
  return one.param == Version::k5 ? "Mqtt5" : "Mqtt311";
}

INSTANTIATE_TEST_SUITE_P(Versions, MqttMosquitto, ::testing::Values(Version::k311, Version::k5),
                         NameOf);
INSTANTIATE_TEST_SUITE_P(Versions, MqttTls, ::testing::Values(Version::k311, Version::k5), NameOf);

}  // namespace
}  // namespace uplink::mqtt
