// A server and the broker that it reads: what is stored, what comes again, what is lost.
#include "tests/component/uplinkd/reading.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "tests/support/sqlite_shell.h"

namespace uplink::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kPosition = R"({"source_type":"edge","position":{"x":1,"y":2,"z":3}})";

class Reading : public ::testing::TestWithParam<std::string> {
 protected:
  static MosquittoOptions WithAQueue() {
    MosquittoOptions options;
    options.lines = "max_queued_messages 100000\n";
    options.tells_packets = false;
    return options;
  }
  [[nodiscard]] std::unique_ptr<ReadingServer> Serve(std::vector<std::string> more = {}) {
    more.push_back("UPLINKD_MQTT_VERSION=" + GetParam());
    auto server = std::make_unique<ReadingServer>(folder_, broker_.port(), more);
    EXPECT_TRUE(server->Subscribed()) << server->process().text();
    return server;
  }
  /// How often each event of the bench is stored.
  [[nodiscard]] std::string Stored() const {
    SqliteShell shell(folder_.Path("uplinkd.db"));
    return shell.Read(
        "SELECT count(*) || ' rows, ' || count(DISTINCT detail) || ' numbers' FROM events "
        "WHERE kind = 'cyberwave/bench'");
  }

  UplinkdFolder folder_;
  Mosquitto broker_{WithAQueue()};
};

INSTANTIATE_TEST_SUITE_P(Versions, Reading, ::testing::Values("5", "3.1.1"),
                         [](const auto& each) { return each.param == "5" ? "V5" : "V311"; });

TEST_P(Reading, EachClassOfMessageLandsWhereItBelongs) {
  const auto server = Serve();
  MqttPublisher publisher(broker_.port());
  publisher.PublishLive(TwinTopic(1, "position"), kPosition);
  publisher.Publish(TwinTopic(1, "event"), NumberedEvent(1));
  publisher.Publish(TwinTopic(1, "event"), "{");
  publisher.Publish(TwinTopic(1, "driverlog"), R"({"message":"warm","level":"warning"})");
  publisher.Publish("cyberwave/environment/" + TwinId(9) + "/joined",
                    R"({"type":"joined","data":{}})");
  ASSERT_TRUE(Eventually([&] { return server->Settled("stored") >= 3; }));
  ASSERT_TRUE(Eventually([&] { return server->Settled("rejected") >= 1; }));
  EXPECT_EQ(server->PresenceOf(1), "online");
  const std::string robot = "?ruri=rcan%3A%2F%2Flocal.rcan%2Fcyberwave%2Ftwin%2F" + TwinId(1);
  EXPECT_THAT(server->Get("/api/v1/events" + robot), HasSubstr("cyberwave/bench"));
  EXPECT_THAT(server->Get("/api/v1/messages" + robot), HasSubstr("warm"));
  EXPECT_THAT(server->Get("/api/v1/quarantine" + robot), HasSubstr("malformed"));
  EXPECT_THAT(server->Get("/api/v1/scope-updates?scope=environment&id=" + TwinId(9)),
              HasSubstr("joined"));
  EXPECT_THAT(server->Get("/api/v1/robots"), Not(HasSubstr("cyberwave:")));
  EXPECT_EQ(server->Sample("uplinkd_mqtt_messages_received_total"), 5);
  EXPECT_EQ(server->Sample("uplinkd_mqtt_messages_in_flight"), 0);
  EXPECT_EQ(server->Sample("uplinkd_uplinks_received_total"), 0);
}

TEST_P(Reading, WhatIsPublishedWhileTheServerIsAwayComesLater) {
  {
    const auto server = Serve();
    server->process().Signal(SIGTERM);
    ASSERT_EQ(server->process().WaitForExit(), 0) << server->process().text();
  }
  MqttPublisher publisher(broker_.port());
  for (int i = 1; i <= 50; ++i) publisher.Publish(TwinTopic(i % 5, "event"), NumberedEvent(i));
  const auto server = Serve();
  ASSERT_TRUE(Eventually([&] { return server->Settled("stored") >= 50; }));
  EXPECT_EQ(Stored(), "50 rows, 50 numbers\n");
}

TEST_P(Reading, AKilledServerStoresEachMessageOnce) {
  MqttPublisher publisher(broker_.port());
  int number = 0;
  for (int round = 0; round < 4; ++round) {
    const auto server = Serve();
    for (int i = 0; i < 100; ++i) {
      ++number;
      publisher.Publish(TwinTopic(number % 7, "event"), NumberedEvent(number));
    }
    server->process().Signal(SIGKILL);
    ASSERT_TRUE(server->process().WaitForExit().has_value());
  }
  const auto server = Serve();
  ASSERT_TRUE(Eventually([&] { return Stored() == "400 rows, 400 numbers\n"; })) << Stored();
}

TEST_P(Reading, ABrokerThatRestartsLosesNothingAndTakesNobodyOffline) {
  const auto server = Serve({"UPLINKD_CYBERWAVE_PRESENCE_TIMEOUT=5s"});
  {
    MqttPublisher publisher(broker_.port());
    publisher.PublishLive(TwinTopic(1, "position"), kPosition);
    publisher.Publish(TwinTopic(1, "event"), NumberedEvent(1));
    ASSERT_TRUE(Eventually([&] { return server->PresenceOf(1) == "online"; }));
  }
  broker_.Stop();
  ASSERT_TRUE(Eventually([&] { return server->PresenceOf(1) == "unknown"; }));
  EXPECT_TRUE(server->Degraded("mqtt_away"));
  broker_.Start();
  ASSERT_TRUE(server->Subscribed());
  EXPECT_FALSE(server->Degraded("mqtt_session_lost"));
  MqttPublisher publisher(broker_.port());
  publisher.Publish(TwinTopic(1, "event"), NumberedEvent(2));
  ASSERT_TRUE(Eventually([&] { return server->Settled("stored") >= 2; }));
  // It says nothing more, and we hear.
  ASSERT_TRUE(Eventually([&] { return server->PresenceOf(1) == "offline"; }));
  EXPECT_EQ(Stored(), "2 rows, 2 numbers\n");
}

TEST_P(Reading, ATwinPastItsFlowCostsOnlyItself) {
  constexpr int kBurst = 20;
  constexpr int kEvents = 500;
  const auto server = Serve({"UPLINKD_LIMITS_DURABLE_RECORDS_RATE=1",
                             "UPLINKD_LIMITS_DURABLE_RECORDS_BURST=" + std::to_string(kBurst)});
  MqttPublisher publisher(broker_.port());
  const auto received = [&] { return server->Sample("uplinkd_mqtt_messages_received_total"); };
  for (int i = 1; i <= kEvents; ++i) publisher.PublishLive(TwinTopic(1, "event"), NumberedEvent(i));
  for (int i = 1; i <= 5; ++i) {
    publisher.PublishLive(TwinTopic(2, "event"), NumberedEvent(kEvents + i));
  }
  ASSERT_TRUE(Eventually([&] {
    return received() == kEvents + 5 && server->Sample("uplinkd_mqtt_messages_in_flight") == 0;
  }));
  const double limited = server->Sample("uplinkd_mqtt_rejects_total{reason=\"rate_limited\"}");
  EXPECT_GT(limited, 0);
  EXPECT_LE(limited, kEvents - kBurst);
  EXPECT_EQ(server->Settled("rejected"), limited);
  EXPECT_EQ(server->Settled("stored"), kEvents + 5 - limited);
  EXPECT_TRUE(server->process().WaitFor("twin_limited robot=rcan://local.rcan/cyberwave/twin/" +
                                        TwinId(1)));
  EXPECT_THAT(server->process().text(), Not(HasSubstr("twin/" + TwinId(2) + " why")));
  EXPECT_THAT(server->Get("/api/v1/quarantine"), Not(HasSubstr("rate_limited")));
  // At QoS 1 our acks hold the publisher back: a backlog passes.
  for (int i = 1; i <= 2 * kBurst; ++i) {
    publisher.Publish(TwinTopic(1, "event"), NumberedEvent(1000 + i));
  }
  ASSERT_TRUE(
      Eventually([&] { return server->Settled("stored") == kEvents + 5 - limited + 2 * kBurst; }));
  EXPECT_EQ(server->Settled("rejected"), limited);
}

TEST(ReadingWithoutPersistence, ALostSessionIsSaid) {
  UplinkdFolder folder;
  MosquittoOptions options;
  options.lines = "persistence false\n";
  options.tells_packets = false;
  Mosquitto broker(options);
  ReadingServer server(folder, broker.port());
  ASSERT_TRUE(server.Subscribed());
  broker.Stop();
  broker.Start();
  ASSERT_TRUE(Eventually([&] { return server.Degraded("mqtt_session_lost"); }));
  EXPECT_GE(server.Sample("uplinkd_mqtt_sessions_lost_total"), 1);
}

TEST(ReadingWithAPassword, IsRefusedWithoutIt) {
  UplinkdFolder folder;
  MosquittoOptions options;
  options.tells_packets = false;
  options.users = {{"uplinkd", "secret"}, {"twin", "other"}};
  Mosquitto broker(options);
  folder.Write("good", "secret\n");
  folder.Write("bad", "wrong\n");
  {
    ReadingServer server(
        folder, broker.port(),
        {"UPLINKD_MQTT_USERNAME=uplinkd", "UPLINKD_MQTT_PASSWORD_FILE=" + folder.Path("bad")});
    ASSERT_TRUE(server.process().WaitFor("reason=refused")) << server.process().text();
    EXPECT_TRUE(server.Degraded("mqtt_away"));
    EXPECT_THAT(server.process().text(), Not(HasSubstr("wrong")));
  }
  ReadingServer server(
      folder, broker.port(),
      {"UPLINKD_MQTT_USERNAME=uplinkd", "UPLINKD_MQTT_PASSWORD_FILE=" + folder.Path("good")});
  EXPECT_TRUE(server.Subscribed());
}

}  // namespace
}  // namespace uplink::testing
