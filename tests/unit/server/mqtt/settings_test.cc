#include "server/mqtt/settings.h"

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "server/config/load.h"
#include "server/mqtt/limits.h"
#include "server/mqtt/outbox.h"
#include "server/mqtt/secrets.h"
#include "tests/support/certificates.h"
#include "tests/support/pem_texts.h"
#include "tests/support/temp_folder.h"

namespace uplink::mqtt {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

ClientSettings Good() {
  ClientSettings settings;
  settings.url = {false, "broker", 1883};
  settings.client_id = "core";
  return settings;
}

TEST(MqttSettings, SayWhatIsWrongByTheirKey) {
  struct Case {
    std::function<void(ClientSettings&)> change;
    /// Empty: good.
    std::string says;
  };
  using S = ClientSettings;
  const std::vector<Case> cases = {
      {[](S&) {}, ""},
      {[](S& s) { s.url.host.clear(); }, "mqtt.url "},
      {[](S& s) { s.client_id.clear(); }, "mqtt.client_id is empty"},
      {[](S& s) { s.client_id.assign(kClientIdBytesMax, 'c'); }, ""},
      {[](S& s) { s.client_id.assign(kClientIdBytesMax + 1, 'c'); },
       "mqtt.client_id has 257 bytes, at most 256"},
      {[](S& s) { s.client_id = "a\n"; }, "mqtt.client_id holds what is not text"},
      {[](S& s) { s.client_id = "\xFF"; }, "mqtt.client_id holds what is not text"},
      {[](S& s) { s.username.assign(kUsernameBytesMax + 1, 'c'); }, "mqtt.username has 1025 bytes"},
      {[](S& s) { s.password_file = "p"; }, "mqtt.password_file needs mqtt.username"},
      {[](S& s) { s.certificate_file = "p"; },
       "mqtt.client_certificate_file and mqtt.client_key_file"},
      {[](S& s) { s.ca_file = "p"; }, "mqtt.url is mqtt://, which has no TLS"},
      {[](S& s) { s.keepalive = std::chrono::seconds(1); }, ""},
      {[](S& s) { s.keepalive = std::chrono::seconds(0); }, "mqtt.keepalive is 0 s, from 1 to"},
      {[](S& s) { s.keepalive = std::chrono::seconds(65'535); }, ""},
      {[](S& s) { s.keepalive = std::chrono::seconds(65'536); }, "mqtt.keepalive is 65536 s"},
      {[](S& s) { s.session_expiry = std::chrono::seconds(0); }, ""},
      {[](S& s) {
         s.session_expiry = std::chrono::seconds(0);
         s.kept_session = true;
       },
       "mqtt.session_expiry is 0 s, from 1 to 4294967294"},
      {[](S& s) { s.unacked_max = 0; }, "mqtt.unacked_max is 0, from 1 to 32767"},
      {[](S& s) { s.unacked_max = 32'767; }, ""},
      {[](S& s) { s.unacked_max = 32'768; }, "mqtt.unacked_max is 32768"},
      {[](S& s) { s.payload_bytes_max = kRemainingLengthMax + 1; }, "payload_bytes_max"},
  };
  for (const Case& each : cases) {
    ClientSettings settings = Good();
    each.change(settings);
    const absl::Status checked = CheckSettings(settings);
    EXPECT_EQ(checked.ok(), each.says.empty()) << each.says << checked;
    EXPECT_THAT(std::string(checked.message()), StartsWith(each.says));
  }
}

TEST(MqttSettings, FiltersHaveWildcardsWhereMqttHasThem) {
  for (const std::string good : {"a", "#", "+", "a/#", "+/b/+", "a//b", "/", "a/+/#"}) {
    EXPECT_TRUE(CheckFilters({{good}}).ok()) << good;
  }
  for (const std::string bad : {"", "a#", "#/a", "a+", "+a/b", "a/#/b", "\xFF"}) {
    EXPECT_FALSE(CheckFilters({{bad}}).ok()) << bad;
  }
  EXPECT_TRUE(CheckFilters({{std::string(kFilterBytesMax, 'a')}}).ok());
  EXPECT_FALSE(CheckFilters({{std::string(kFilterBytesMax + 1, 'a')}}).ok());
  EXPECT_TRUE(CheckFilters(std::vector<Filter>(kFiltersMax, Filter{"a"})).ok());
  EXPECT_FALSE(CheckFilters(std::vector<Filter>(kFiltersMax + 1, Filter{"a"})).ok());
}

void WriteFile(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
  std::filesystem::permissions(
      path, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
}

TEST(MqttSecrets, APasswordIsTheFileWithoutItsLineEnd) {
  const testing::TempFolder folder;
  ClientSettings settings = Good();
  settings.username = "me";
  settings.password_file = folder.File("password");
  for (const std::string& end : {std::string(), std::string("\n"), std::string("\r\n")}) {
    WriteFile(settings.password_file, " secret " + end);
    EXPECT_EQ(*ReadSecrets(settings)->password, " secret ");
  }
  WriteFile(settings.password_file, std::string(kPasswordBytesMax, 'p'));
  EXPECT_EQ(ReadSecrets(settings)->password->size(), kPasswordBytesMax);
}

TEST(MqttSecrets, SayWhichFileIsInvalid) {
  const testing::TempFolder folder;
  ClientSettings settings = Good();
  settings.username = "me";
  settings.password_file = folder.File("password");
  const auto problem = [&] { return std::string(ReadSecrets(settings).status().message()); };
  EXPECT_THAT(problem(), HasSubstr("No such file"));
  WriteFile(settings.password_file, "\n");
  EXPECT_THAT(problem(), HasSubstr("is empty"));
  WriteFile(settings.password_file, std::string(kPasswordBytesMax + 1, 'p'));
  EXPECT_THAT(problem(), HasSubstr("is larger than 4096 bytes"));
  WriteFile(settings.password_file, "secret");
  std::filesystem::permissions(settings.password_file, std::filesystem::perms::others_write,
                               std::filesystem::perm_options::add);
  EXPECT_THAT(problem(), StartsWith("mqtt.password_file: "));
  std::filesystem::remove(settings.password_file);
  ASSERT_EQ(mkfifo(settings.password_file.c_str(), 0600), 0);
  EXPECT_THAT(problem(), HasSubstr("password: is not a regular file; name one"));
  settings.password_file.clear();
  settings.ca_file = folder.File("ca");
  EXPECT_THAT(problem(), StartsWith("mqtt.ca_file: "));
}

TEST(MqttSecrets, ACertificateHasItsExpiry) {
  const testing::TempFolder folder;
  ClientSettings settings = Good();
  EXPECT_EQ(*CertificateExpiry(settings), std::nullopt);
  settings.certificate_file = folder.File("client.crt");
  testing::CertificateSpec spec = testing::RobotSpec("rcan://a");
  spec.not_after_s = 7'200;
  const SystemTime before = SystemClock().System();
  WriteFile(settings.certificate_file, testing::TestAuthority().Issue(spec).certificate);
  EXPECT_TRUE(ReadSecrets(settings).ok());
  const auto expiry = CertificateExpiry(settings);
  ASSERT_TRUE(expiry.ok() && *expiry) << expiry.status();
  EXPECT_GT(**expiry, before + std::chrono::hours(1));
  EXPECT_LT(**expiry, before + std::chrono::hours(3));
  WriteFile(settings.certificate_file, "no certificate");
  EXPECT_THAT(std::string(ReadSecrets(settings).status().message()),
              HasSubstr("mqtt.client_certificate_file"));
  EXPECT_THAT(std::string(CertificateExpiry(settings).status().message()),
              HasSubstr("mqtt.client_certificate_file"));
}

TEST(MqttSecrets, AreRefusedForWhatAStartRefusesToo) {
  const testing::TempFolder folder;
  const testing::TestAuthority authority;
  const testing::KeyPair pair = authority.Issue(testing::RobotSpec("rcan://a"));
  const std::string broken = testing::With(authority.certificate(), "\nMII", "\nXXX");
  config::Config config;
  config.mqtt.url = "mqtts://broker";
  config.store.url = "sqlite://" + folder.File("uplinkd.db");
  ClientSettings settings = Good();
  settings.ca_file = config.mqtt.ca_file = folder.File("ca.crt");
  settings.certificate_file = config.mqtt.client_certificate_file = folder.File("client.crt");
  settings.key_file = config.mqtt.client_key_file = folder.File("client.key");
  const auto expect = [&](const std::string& ca, const std::string& certificate,
                          const std::string& key, const std::string& says) {
    WriteFile(settings.ca_file, ca);
    WriteFile(settings.certificate_file, certificate);
    WriteFile(settings.key_file, key);
    EXPECT_THAT(std::string(ReadSecrets(settings).status().message()), HasSubstr(says)) << key;
    // Of [mqtt] alone: no other file is named.
    std::string at_a_start;
    for (const config::Problem& problem : config::ValidateFiles(config)) at_a_start = problem.text;
    EXPECT_EQ(at_a_start.empty(), says.empty()) << at_a_start;
  };
  const std::string& ca = authority.certificate();
  expect(ca, pair.certificate, pair.key, "");
  expect(ca, pair.certificate + ca, testing::EcparamKey(pair.key), "");
  expect(ca + broken, pair.certificate, pair.key,
         "mqtt.ca_file: " + settings.ca_file + ": PEM block 2, from line ");
  expect(
      ca, pair.certificate + broken, pair.key,
      "mqtt.client_certificate_file: " + settings.certificate_file + ": PEM block 2, from line ");
  expect(ca, pair.certificate, testing::LockedKey(pair.key),
         "mqtt.client_key_file: " + settings.key_file + ": PEM block 1, from line 1, ");
  expect(ca, pair.certificate, pair.key + pair.key, "is a second private key");
  expect(ca, pair.certificate, authority.Issue(testing::RobotSpec("rcan://a")).key,
         "mqtt.client_key_file: " + settings.key_file + ": is not the key of ");
}

TEST(MqttOutbox, AMessageJoinsWhileThereIsRoomAndAnAckAlways) {
  Outbox outbox(10);
  EXPECT_TRUE(outbox.AddIfRoom("12345"));
  EXPECT_EQ(outbox.Take(), "12345");
  EXPECT_TRUE(outbox.writing());
  EXPECT_TRUE(outbox.AddIfRoom("67890")) << "what is being written counts";
  EXPECT_FALSE(outbox.AddIfRoom("x"));
  outbox.Add("ack");
  outbox.Written();
  EXPECT_FALSE(outbox.AddIfRoom("xyz"));
  EXPECT_EQ(outbox.Take(), "67890ack");
  outbox.Written();
  EXPECT_EQ(outbox.bytes(), 0U);
}

}  // namespace
}  // namespace uplink::mqtt
