// Two servers that share a store and a client id: one reads the broker, and the other goes on where
// it ended.
#include <array>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "tests/component/uplinkd/reading.h"
#include "tests/support/postgres_database.h"

namespace uplink::testing {
namespace {

class TwoReaders : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.Write("password", "uplinkd\n");
    for (std::size_t i = 0; i < servers_.size(); ++i) Serve(i);
  }
  static MosquittoOptions Lines() {
    MosquittoOptions options;
    options.lines = "max_queued_messages 100000\n";
    options.tells_packets = false;
    return options;
  }
  void Serve(std::size_t which) {
    servers_[which] = std::make_unique<ReadingServer>(
        folder_, broker_.port(),
        std::vector<std::string>{
            "UPLINKD_STORE_URL=postgresql://uplinkd@127.0.0.1:" + database_.cluster().port + "/" +
                database_.name() + "?sslmode=disable",
            "UPLINKD_STORE_PASSWORD_FILE=" + folder_.Path("password")});
  }
  /// The one that has the lease.
  [[nodiscard]] std::size_t Holder() {
    std::size_t holder = servers_.size();
    EXPECT_TRUE(Eventually(
        [&] {
          for (std::size_t i = 0; i < servers_.size(); ++i) {
            if (servers_[i]->Sample("uplinkd_mqtt_lease_held") == 1 && servers_[i]->Subscribed()) {
              holder = i;
            }
          }
          return holder < servers_.size();
        },
        2 * kPatience));
    return holder;
  }
  [[nodiscard]] std::string Stored() {
    return PostgresShell(database_.url())
        .Read(
            "SELECT count(*) || ' rows, ' || count(DISTINCT detail::text) || ' numbers' "
            "FROM uplinkd.events WHERE kind = 'cyberwave/bench'");
  }

  UplinkdFolder folder_;
  PostgresDatabase database_;
  Mosquitto broker_{Lines()};
  std::array<std::unique_ptr<ReadingServer>, 2> servers_;
};

TEST_F(TwoReaders, EachKilledInTurnStoreEachMessageOnce) {
  MqttPublisher publisher(broker_.port());
  int number = 0;
  for (int round = 0; round < 3; ++round) {
    const std::size_t holder = Holder();
    ASSERT_LT(holder, servers_.size());
    for (int i = 0; i < 100; ++i) {
      ++number;
      publisher.Publish(TwinTopic(number % 7, "event"), NumberedEvent(number));
    }
    servers_[holder]->process().Signal(SIGKILL);
    ASSERT_TRUE(servers_[holder]->process().WaitForExit().has_value());
    ASSERT_EQ(Holder(), 1 - holder);
    Serve(holder);
  }
  ASSERT_TRUE(Eventually([&] { return Stored() == "300 rows, 300 numbers\n"; })) << Stored();
}

TEST_F(TwoReaders, OneThatStopsGivesTheBrokerToTheOther) {
  const std::size_t holder = Holder();
  const std::size_t other = 1 - holder;
  MqttPublisher publisher(broker_.port());
  publisher.PublishLive(TwinTopic(1, "position"),
                        R"({"source_type":"edge","position":{"x":1,"y":2,"z":3}})");
  ASSERT_TRUE(Eventually([&] { return servers_[holder]->PresenceOf(1) == "online"; }));
  EXPECT_TRUE(Eventually([&] { return !servers_[other]->Degraded("mqtt_away"); }))
      << "once it has looked it knows that the other one reads";
  servers_[holder]->process().Signal(SIGTERM);
  ASSERT_EQ(servers_[holder]->process().WaitForExit(), 0);
  ASSERT_TRUE(Eventually([&] { return servers_[other]->Sample("uplinkd_mqtt_lease_held") == 1; }));
  ASSERT_TRUE(servers_[other]->Subscribed());
  publisher.Publish(TwinTopic(1, "event"), NumberedEvent(1));
  ASSERT_TRUE(Eventually([&] { return servers_[other]->Settled("stored") >= 1; }));
  EXPECT_EQ(Stored(), "1 rows, 1 numbers\n");
}

TEST_F(TwoReaders, OneThatStoodStillTakesNothingBackFromTheOther) {
  const std::size_t holder = Holder();
  const std::size_t other = 1 - holder;
  servers_[holder]->process().Signal(SIGSTOP);
  // Its lease falls silent.
  ASSERT_TRUE(Eventually([&] { return servers_[other]->Sample("uplinkd_mqtt_lease_held") == 1; },
                         std::chrono::seconds(60)));
  ASSERT_TRUE(servers_[other]->Subscribed());
  servers_[holder]->process().Signal(SIGCONT);
  MqttPublisher publisher(broker_.port());
  for (int i = 1; i <= 50; ++i) publisher.Publish(TwinTopic(i % 5, "event"), NumberedEvent(i));
  ASSERT_TRUE(Eventually([&] { return servers_[holder]->Sample("uplinkd_mqtt_lease_held") == 0; }));
  ASSERT_TRUE(Eventually([&] { return Stored() == "50 rows, 50 numbers\n"; })) << Stored();
  EXPECT_EQ(servers_[other]->Sample("uplinkd_mqtt_lease_held"), 1);
}

}  // namespace
}  // namespace uplink::testing
