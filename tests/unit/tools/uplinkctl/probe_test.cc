#include "tools/uplinkctl/probe.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/config/config.h"
#include "tools/uplinkctl/listeners.h"

namespace uplink::ctl {
namespace {

using ::testing::HasSubstr;

TEST(Probe, TheServersOwnWordsAreGood) {
  const ProbeWord ready = JudgeAnswer(Probe::kReady, {200, R"({"degraded":["clock"]})"});
  EXPECT_TRUE(ready.good);
  EXPECT_EQ(ready.line, R"(ready: {"degraded":["clock"]})");
  EXPECT_TRUE(JudgeAnswer(Probe::kAlive, {200, R"({"relayLastHandshakeSeconds":3})"}).good);
}

TEST(Probe, ARefusalSaysWhy) {
  const ProbeWord word = JudgeAnswer(Probe::kReady, {503, R"({"refuses":["starting"]})"});
  EXPECT_FALSE(word.good);
  EXPECT_EQ(word.line, R"(not ready: {"refuses":["starting"]})");
}

TEST(Probe, AnotherProgramOnThePortIsNotGood) {
  const ProbeWord word = JudgeAnswer(Probe::kReady, {200, "<html>\n\x1b[2Jwelcome"});
  EXPECT_FALSE(word.good);
  EXPECT_EQ(word.line,
            "not ready: /readyz answers 200, and not as uplinkd does: <html>??[2Jwelcome");
  // The words of one probe are not the other's.
  EXPECT_FALSE(JudgeAnswer(Probe::kAlive, {200, R"({"degraded":[]})"}).good);
}

TEST(Probe, ALongAnswerIsCut) {
  const std::string exact(kProbeShownMax, 'a');
  EXPECT_THAT(JudgeAnswer(Probe::kAlive, {500, exact}).line, HasSubstr(exact));
  const std::string line = JudgeAnswer(Probe::kAlive, {500, exact + "b"}).line;
  EXPECT_EQ(line.back(), 'a');
}

TEST(Listeners, AClientOnTheMachineAsksAListenerOnAllAddressesOnLoopback) {
  config::Config config;
  EXPECT_EQ(ToText(OwnUrl(config)), "http://127.0.0.1:7480");
  config.listen.http.host = "0.0.0.0";
  EXPECT_EQ(ToText(OwnUrl(config)), "http://127.0.0.1:7480");
  config.listen.http.host = "::";
  EXPECT_EQ(ToText(OwnUrl(config)), "http://127.0.0.1:7480");
  config.listen.http = {.host = {}, .port = 0, .path = "/run/uplinkd/http.sock"};
  EXPECT_EQ(ToText(OwnUrl(config)), "unix:/run/uplinkd/http.sock");
}

TEST(Listeners, HttpsIsSpokenWhereTheMachineMustNotDoWithout) {
  config::Config config;
  config.http.tls_certificate_file = "http.crt";
  EXPECT_EQ(ToText(OwnUrl(config)), "http://127.0.0.1:7480");
  config.listen.http.host = "192.0.2.7";
  EXPECT_EQ(ToText(OwnUrl(config)), "https://192.0.2.7:7480");
  config.http.plain_from = {*config::Network::Parse("192.0.2.0/24")};
  EXPECT_EQ(ToText(OwnUrl(config)), "http://192.0.2.7:7480");
  config.listen.http.host = "::";
  EXPECT_EQ(ToText(OwnUrl(config)), "https://127.0.0.1:7480");
  config.http.tls_certificate_file = "";
  EXPECT_EQ(ToText(OwnUrl(config)), "http://127.0.0.1:7480");
}

}  // namespace
}  // namespace uplink::ctl
