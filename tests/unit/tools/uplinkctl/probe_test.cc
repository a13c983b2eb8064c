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

TEST(Probe, AUrlNamesHostAndPort) {
  EXPECT_EQ(AddressOfUrl("http://127.0.0.1:7480").value(), "127.0.0.1:7480");
  EXPECT_EQ(AddressOfUrl("http://[::1]:65535/").value(), "[::1]:65535");
  EXPECT_EQ(AddressOfUrl("http://uplinkd").value(), "uplinkd:80");
  EXPECT_EQ(AddressOfUrl("http://[::1]").value(), "[::1]:80");
}

TEST(Probe, AnotherUrlIsWrongUse) {
  for (const char* url :
       {"", "127.0.0.1:7480", "https://a:1", "http://", "http://:80", "http://[]:80", "http://[::1",
        "http://::1:80", "http://a:0", "http://a:65536", "http://a:b", "http://a:", "http://a:1/x",
        "http://u@a:1", "http://a:1?b"}) {
    EXPECT_TRUE(absl::IsInvalidArgument(AddressOfUrl(url).status())) << url;
  }
}

TEST(Listeners, ProbesOfAListenerOnAllAddressesGoToLoopback) {
  config::Config config;
  EXPECT_EQ(config::ToText(ProbeAddress(config)), "127.0.0.1:7480");
  config.listen.http.host = "0.0.0.0";
  EXPECT_EQ(config::ToText(ProbeAddress(config)), "127.0.0.1:7480");
  config.listen.http.host = "::";
  EXPECT_EQ(config::ToText(ProbeAddress(config)), "[::1]:7480");
}

}  // namespace
}  // namespace uplink::ctl
