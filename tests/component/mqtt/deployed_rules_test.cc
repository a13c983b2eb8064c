// What deploy/mosquitto/acl lets whom do, by a real mosquitto. Tests start in the tree's top
// folder.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/cyberwave/filters.h"
#include "tests/component/mqtt/client_world.h"
#include "tests/support/mosquitto.h"
#include "tests/support/mqtt_publisher.h"

namespace uplink::mqtt {
namespace {

using cyberwave::Connection;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::Mosquitto;
using testing::MqttPublisher;
using testing::WorldClient;

const std::string kTwin = "3f2504e0-4f89-11d3-9a0c-0305e82c3301";
const std::string kOther = "11111111-4f89-11d3-9a0c-0305e82c3301";

std::string Rules() {
  std::ifstream file("deploy/mosquitto/acl");
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::vector<std::string> AllFilters() {
  std::vector<std::string> all;
  for (const Connection each : {Connection::kDurable, Connection::kLive, Connection::kMedia}) {
    for (std::string& filter : cyberwave::Filters("", each)) all.push_back(std::move(filter));
  }
  return all;
}

class DeployedRulesTest : public ::testing::Test {
 protected:
  /// Settings of a user whose password is its name.
  ClientSettings SettingsOf(const std::string& user) const {
    ClientSettings settings = testing::LoopbackSettings(broker_.port(), Version::k5);
    settings.client_id = "client-of-" + user;
    settings.username = user;
    settings.password_file = folder_.File(user);
    std::ofstream(settings.password_file) << user;
    std::filesystem::permissions(settings.password_file, std::filesystem::perms::owner_read);
    return settings;
  }
  MqttPublisher PublisherOf(const std::string& user) {
    return MqttPublisher(broker_.port(), {}, user, user);
  }

  const testing::TempFolder folder_;
  Mosquitto broker_{
      {.users = {{"uplinkd", "uplinkd"}, {kTwin, kTwin}, {kOther, kOther}}, .acl = Rules()}};
  testing::MqttWorld world_;
};

TEST_F(DeployedRulesTest, UplinkdMayReadEachTopicThatItSubscribesTo) {
  for (const std::string& filter : AllFilters()) {
    EXPECT_THAT(Rules(), HasSubstr("\ntopic read " + filter + "\n"));
  }
}

TEST_F(DeployedRulesTest, ARobotWritesBelowItsOwnTwinAlone) {
  WorldClient uplinkd(world_, SettingsOf("uplinkd"));
  std::vector<Filter> filters;
  for (const std::string& filter : AllFilters()) filters.push_back({filter, Qos::kAtLeastOnce});
  ASSERT_TRUE(uplinkd.Subscribe(filters));
  MqttPublisher robot = PublisherOf(kTwin);
  robot.Publish("cyberwave/twin/" + kOther + "/event", "another's event");
  robot.Publish("cyberwave/joint/" + kOther + "/update", "another's joints");
  robot.Publish("cyberwave/environment/" + kTwin + "/x", "an environment");
  robot.Publish("cyberwave/twin/" + kTwin + "/event", "event");
  robot.Publish("cyberwave/twin/" + kTwin + "/navigate/status", "status");
  robot.Publish("cyberwave/joint/" + kTwin + "/update", "joints");
  robot.Publish("cyberwave/ping/" + kTwin + "/request", "ping");
  ASSERT_TRUE(uplinkd.UntilMessages(4));
  EXPECT_THAT(uplinkd.Payloads(), ElementsAre("event", "status", "joints", "ping"));
}

TEST_F(DeployedRulesTest, UplinkdWritesPongsAlone) {
  WorldClient robot(world_, SettingsOf(kTwin));
  ASSERT_TRUE(robot.Subscribe({{"cyberwave/twin/" + kTwin + "/#", Qos::kAtLeastOnce},
                               {"cyberwave/pong/+/response", Qos::kAtLeastOnce}}));
  MqttPublisher uplinkd = PublisherOf("uplinkd");
  uplinkd.Publish("cyberwave/twin/" + kTwin + "/command", "a command");
  uplinkd.Publish("cyberwave/pong/" + kOther + "/response", "another's pong");
  uplinkd.Publish("cyberwave/pong/" + kTwin + "/response", "pong");
  ASSERT_TRUE(robot.UntilMessages(1));
  EXPECT_THAT(robot.Payloads(), ElementsAre("pong"));
}

}  // namespace
}  // namespace uplink::mqtt
