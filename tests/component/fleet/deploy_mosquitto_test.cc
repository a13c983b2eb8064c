// deploy/mosquitto, as it stands there, before a broker: only paths, port and the process's user
// are the test's.
#include <fstream>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/base/check.h"
#include "tests/component/fleet/broker_client.h"
#include "tests/support/certificates.h"
#include "tests/support/mosquitto.h"
#include "tests/support/temp_folder.h"

namespace uplink::synthetic {
namespace {

using testing::BrokerClient;
using ::testing::HasSubstr;
using testing::KeyPair;
using testing::Mosquitto;
using testing::MosquittoOptions;
using testing::TempFolder;
using testing::TestAuthority;

constexpr const char* kTwin = "11111111-1111-4111-8111-111111111111";
constexpr const char* kOther = "22222222-2222-4222-8222-222222222222";

std::string Below(const char* twin, const char* what) {
  return std::string("cyberwave/twin/") + twin + "/" + what;
}

std::string FileText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  UPLINK_CHECK(file.good(), "tests run in the tree's top folder");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Fails if the setting is not there, since the test would then test nothing.
void Replace(std::string& text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  UPLINK_CHECK(at != std::string::npos, what + " stands in deploy/mosquitto/mosquitto.conf");
  text.replace(at, what.size(), with);
}

class DeployMosquitto : public ::testing::Test {
 protected:
  static MosquittoOptions Options(const KeyPair& pair) {
    MosquittoOptions options;
    options.users = {{"uplinkd", "u"}, {kTwin, "t"}, {kOther, "o"}};
    options.acl = FileText("deploy/mosquitto/acl");
    options.certificate = pair.certificate;
    options.key = pair.key;
    options.configuration = FileText("deploy/mosquitto/mosquitto.conf");
    Replace(options.configuration, "listener 8883", "listener PORT 127.0.0.1");
    Replace(options.configuration, "/etc/mosquitto/certs/server.crt", "FOLDER/cert.pem");
    Replace(options.configuration, "/etc/mosquitto/certs/server.key", "FOLDER/key.pem");
    Replace(options.configuration, "/etc/mosquitto/passwords", "FOLDER/passwords");
    Replace(options.configuration, "/etc/mosquitto/acl", "FOLDER/acl");
    Replace(options.configuration, "/var/lib/mosquitto/", "FOLDER/");
    options.configuration += "user root\nlog_dest stderr\nlog_timestamp false\n";
    return options;
  }

  [[nodiscard]] BrokerSettings As(const std::string& user, const std::string& password) {
    BrokerSettings settings;
    settings.url = {.tls = true, .host = "localhost", .port = broker_.port()};
    settings.username = user;
    settings.password = password;
    settings.ca_file = folder_.File("ca.pem");
    std::ofstream(settings.ca_file) << authority_.certificate();
    return settings;
  }

  TempFolder folder_;
  TestAuthority authority_;
  BrokerLibrary library_;
  Mosquitto broker_{Options(authority_.Issue(testing::ServerSpec()))};
};

TEST_F(DeployMosquitto, ARobotWritesBelowItsOwnTwinOnly) {
  BrokerClient uplinkd(As("uplinkd", "u"));
  ASSERT_TRUE(uplinkd.connected()) << uplinkd.status();
  uplinkd.Subscribe("cyberwave/#");
  BrokerClient twin(As(kTwin, "t"));
  ASSERT_TRUE(twin.connected()) << twin.status();
  for (const char* what : {"event", "telemetry", "navigate/status"}) {
    EXPECT_THAT(twin.Publish(Below(kOther, what), "{}"), HasSubstr("Not authorized")) << what;
    EXPECT_EQ(twin.Publish(Below(kTwin, what), "{}"), "") << what;
  }
  const std::string joint = "cyberwave/joint/";
  EXPECT_EQ(twin.Publish(joint + kTwin + "/update", "{}"), "");
  EXPECT_THAT(twin.Publish(joint + kOther + "/update", "{}"), HasSubstr("Not authorized"));
  EXPECT_THAT(twin.Publish(std::string("cyberwave/pong/") + kTwin + "/response", "{}"),
              HasSubstr("Not authorized"));
  EXPECT_THAT(twin.Publish("cyberwave/environment/e/x", "{}"), HasSubstr("Not authorized"));
  EXPECT_EQ(twin.Publish(std::string("cyberwave/ping/") + kTwin + "/request", "{}"), "");
  ASSERT_TRUE(uplinkd.Until([&] { return uplinkd.messages().size() >= 5; }));
  for (const auto& message : uplinkd.messages()) {
    EXPECT_THAT(message.topic, HasSubstr(kTwin)) << "only what was allowed came through";
  }
}

TEST_F(DeployMosquitto, UplinkdReadsAndAnswersPingsAlone) {
  BrokerClient uplinkd(As("uplinkd", "u"));
  ASSERT_TRUE(uplinkd.connected()) << uplinkd.status();
  BrokerClient twin(As(kTwin, "t"));
  ASSERT_TRUE(twin.connected()) << twin.status();
  const std::string pong = std::string("cyberwave/pong/") + kTwin + "/response";
  twin.Subscribe(pong);
  // The answer to what follows the subscription says that it is there.
  EXPECT_EQ(twin.Publish(Below(kTwin, "event"), "{}"), "");
  for (const std::string& topic :
       {Below(kTwin, "event"), Below(kTwin, "command"), Below("uplinkd", "event"),
        std::string("cyberwave/joint/uplinkd/update"),
        std::string("cyberwave/ping/uplinkd/request"), std::string("elsewhere")}) {
    EXPECT_THAT(uplinkd.Publish(topic, "{}"), HasSubstr("Not authorized")) << topic;
  }
  EXPECT_EQ(uplinkd.Publish(pong, "{\"type\":\"pong\"}"), "");
  ASSERT_TRUE(twin.Until([&] { return !twin.messages().empty(); }));
  EXPECT_EQ(twin.messages().front().topic, pong);
}

TEST_F(DeployMosquitto, ARobotHearsNothingOfAnother) {
  BrokerClient twin(As(kTwin, "t"));
  ASSERT_TRUE(twin.connected()) << twin.status();
  twin.Subscribe("cyberwave/#");
  BrokerClient other(As(kOther, "o"));
  ASSERT_TRUE(other.connected()) << other.status();
  EXPECT_EQ(other.Publish(Below(kOther, "event"), "{}"), "");
  EXPECT_EQ(twin.Publish(Below(kTwin, "event"), "{}"), "");
  ASSERT_TRUE(twin.Until([&] { return !twin.messages().empty(); }));
  EXPECT_EQ(twin.messages().front().topic, Below(kTwin, "event"));
}

TEST_F(DeployMosquitto, NobodyComesWithoutAPassword) {
  for (const BrokerSettings& settings : {As("", ""), As("uplinkd", "wrong"), As("unknown", "u")}) {
    BrokerClient client(settings);
    EXPECT_FALSE(client.connected());
    EXPECT_THAT(client.status().message(), HasSubstr("does not let us in"));
  }
}

TEST_F(DeployMosquitto, ABrokerThatNobodyVouchesForIsNotSpokenTo) {
  BrokerSettings settings = As("uplinkd", "u");
  std::ofstream(settings.ca_file) << TestAuthority("another").certificate();
  BrokerClient client(settings);
  EXPECT_FALSE(client.connected());
}

}  // namespace
}  // namespace uplink::synthetic
