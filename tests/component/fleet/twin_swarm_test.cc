// Twins before a real broker: what they publish comes through, and they know what the broker took.
#include "tools/uplink-fleet/broker/twin_swarm.h"

#include <chrono>
#include <map>
#include <optional>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/component/fleet/broker_client.h"
#include "tests/support/mosquitto.h"

namespace uplink::synthetic {
namespace {

using testing::BrokerClient;
using ::testing::HasSubstr;
using testing::Mosquitto;
using testing::MosquittoOptions;

/// Enough for 20 twins at full rate, so that nothing is dropped unseen; and few lines of log, since
/// it is not read meanwhile.
constexpr const char* kConfiguration =
    "user root\nlog_dest stderr\nlog_type information\nlog_type error\nlog_timestamp false\n"
    "persistence true\npersistence_location FOLDER/\nlistener PORT 127.0.0.1\n"
    "max_queued_messages 100000\nmax_inflight_messages 1000\n";

class TwinsOnBroker : public ::testing::Test {
 protected:
  void StartBroker(MosquittoOptions options = {}) {
    options.configuration = kConfiguration;
    options.configuration += options.users.empty()
                                 ? "allow_anonymous true\n"
                                 : "allow_anonymous false\npassword_file FOLDER/passwords\n";
    if (!options.acl.empty()) options.configuration += "acl_file FOLDER/acl\n";
    broker_.emplace(options);
  }
  [[nodiscard]] BrokerSettings Settings() const {
    BrokerSettings settings;
    settings.url = {.tls = false, .host = "127.0.0.1", .port = broker_->port()};
    return settings;
  }
  [[nodiscard]] TwinSwarmOptions Twins(std::size_t twins) const {
    TwinSwarmOptions options;
    options.broker = Settings();
    options.run = "run1";
    options.rate_hz = 100;
    options.twins = twins;
    return options;
  }
  /// Answers pings, as uplinkd does.
  static void Answer(BrokerClient& client, std::size_t& answered) {
    for (; answered < client.messages().size(); ++answered) {
      const std::string& topic = client.messages()[answered].topic;
      if (!topic.starts_with("cyberwave/ping/")) continue;
      std::string pong = topic;
      pong.replace(pong.find("ping"), 4, "pong").replace(pong.rfind("request"), 7, "response");
      (void)client.Publish(pong, "{\"type\":\"pong\"}");
    }
  }

  SystemClock clock_;
  BrokerLibrary library_;
  std::optional<Mosquitto> broker_;
  TwinsShared shared_;
};

TEST_F(TwinsOnBroker, WhatTheyPublishComesThroughAndTheyKnowIt) {
  StartBroker();
  BrokerClient reader(Settings());
  ASSERT_TRUE(reader.connected()) << reader.status();
  reader.Subscribe("cyberwave/#");
  ASSERT_EQ(reader.Publish("cyberwave/begin", ""), "");
  ASSERT_TRUE(reader.Until([&] { return !reader.messages().empty(); })) << "it is subscribed";
  TwinSwarm swarm(Twins(20), clock_, shared_);
  EXPECT_EQ(swarm.groups(), 3U);
  swarm.Start();
  std::size_t answered = 0;
  ASSERT_TRUE(reader.Until([&] {
    Answer(reader, answered);
    return shared_.published.load() > 2000 && shared_.pongs.load() >= 3;
  }));
  shared_.stage.store(TwinStage::kSettle);
  ASSERT_TRUE(reader.Until([&] { return shared_.settled_groups.load() == 3; }))
      << shared_.settled_groups.load() << " groups, " << shared_.acked.load() << " of "
      << shared_.published_qos1.load() << " acked; " << reader.status()
      << shared_.first_error.Read();
  shared_.stage.store(TwinStage::kLast);
  ASSERT_TRUE(reader.Until([&] { return shared_.quiet_groups.load() == 3; }));
  shared_.stage.store(TwinStage::kClose);
  swarm.Finish();
  EXPECT_EQ(shared_.acked.load(), shared_.published_qos1.load());
  EXPECT_EQ(shared_.breaks.load(), 0U) << shared_.first_error.Read();

  // Each publication was counted by both sides, pongs and the reader's own first one apart.
  std::uint64_t pongs = 0;
  const auto own = [&](const BrokerClient::Message& each) {
    if (each.topic.starts_with("cyberwave/pong/")) ++pongs;
    return each.topic.starts_with("cyberwave/pong/") || each.topic == "cyberwave/begin";
  };
  std::uint64_t came = 0;
  std::size_t counted = 0;
  ASSERT_TRUE(reader.Until([&] {
    for (; counted < reader.messages().size(); ++counted) {
      if (!own(reader.messages()[counted])) ++came;
    }
    return came >= shared_.published.load();
  })) << came
      << " of " << shared_.published.load();
  EXPECT_EQ(came, shared_.published.load());

  // And each that must be stored came once, by its mark.
  std::map<std::size_t, std::multiset<std::uint64_t>> marks;
  swarm.ForEach([&](const TwinScript& twin) {
    EXPECT_EQ(twin.account().waiting(), 0U);
    EXPECT_EQ(twin.account().refused(), 0U);
    for (const auto& message : reader.messages()) {
      const auto number = MarkIn(twin.options(), message.payload);
      if (number && twin.account().rows().contains(*number)) {
        marks[twin.options().index].insert(*number);
      }
    }
    for (const auto& [number, row] : twin.account().rows()) {
      EXPECT_EQ(marks[twin.options().index].count(number), 1U) << "number " << number;
      EXPECT_EQ(twin.account().DeliveryOf(number), Delivery::kOnce);
    }
  });
}

TEST_F(TwinsOnBroker, ABrokerThatRestartsGetsAllOfIt) {
  StartBroker();
  TwinSwarm swarm(Twins(8), clock_, shared_);
  swarm.Start();
  ASSERT_TRUE(testing::Eventually([&] { return shared_.acked.load() > 50; }));
  broker_->Stop();
  ASSERT_TRUE(testing::Eventually([&] { return shared_.breaks.load() == 1; }));
  broker_->Start();
  ASSERT_TRUE(testing::Eventually([&] { return shared_.connections.load() == 2; }));
  shared_.stage.store(TwinStage::kSettle);
  ASSERT_TRUE(testing::Eventually([&] { return shared_.settled_groups.load() == 1; }));
  EXPECT_EQ(shared_.acked.load(), shared_.published_qos1.load());
  shared_.stage.store(TwinStage::kClose);
  swarm.Finish();
}

TEST_F(TwinsOnBroker, WhatTheBrokerRefusesIsKnown) {
  MosquittoOptions options;
  options.users = {{"fleet", "f"}};
  // Everything but events.
  options.acl =
      "user fleet\ntopic write cyberwave/joint/+/update\ntopic write cyberwave/ping/+/request\n";
  StartBroker(options);
  TwinSwarmOptions twins = Twins(1);
  twins.broker.username = "fleet";
  twins.broker.password = "f";
  TwinSwarm swarm(twins, clock_, shared_);
  swarm.Start();
  ASSERT_TRUE(testing::Eventually([&] { return !shared_.first_error.Read().empty(); }));
  EXPECT_THAT(shared_.first_error.Read(), HasSubstr("refused a publication: Not authorized"));
  shared_.stage.store(TwinStage::kSettle);
  ASSERT_TRUE(testing::Eventually([&] { return shared_.settled_groups.load() == 1; }));
  shared_.stage.store(TwinStage::kClose);
  swarm.Finish();
  swarm.ForEach([&](const TwinScript& twin) {
    EXPECT_GT(twin.account().refused(), 0U);
    EXPECT_EQ(twin.account().acked() + twin.account().refused(), shared_.published_qos1.load());
  });
}

TEST_F(TwinsOnBroker, ABrokerThatLetsNobodyInIsToldOf) {
  MosquittoOptions options;
  options.users = {{"fleet", "f"}};
  StartBroker(options);
  TwinSwarm swarm(Twins(1), clock_, shared_);
  swarm.Start();
  ASSERT_TRUE(testing::Eventually([&] { return !shared_.first_error.Read().empty(); }));
  EXPECT_THAT(shared_.first_error.Read(), HasSubstr("does not let us in"));
  EXPECT_EQ(shared_.connections.load(), 0U);
}

TEST_F(TwinsOnBroker, ASlowBrokerHoldsThemBack) {
  // While the broker is stopped, what is published waits, up to a bound.
  StartBroker();
  TwinSwarmOptions twins = Twins(8);
  twins.rate_hz = 200;
  TwinSwarm swarm(twins, clock_, shared_);
  swarm.Start();
  ASSERT_TRUE(testing::Eventually([&] { return shared_.acked.load() > 50; }));
  broker_->Stop();
  ASSERT_TRUE(testing::Eventually([&] { return shared_.breaks.load() == 1; }));
  const std::uint64_t published = shared_.published.load();
  EXPECT_LE(shared_.published_qos1.load() - shared_.acked.load(), kGroupUnackedMax);
  broker_->Start();
  ASSERT_TRUE(testing::Eventually([&] { return shared_.published.load() > published; }));
}

}  // namespace
}  // namespace uplink::synthetic
