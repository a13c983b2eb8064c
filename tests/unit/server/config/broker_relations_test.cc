#include "server/config/broker_relations.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/config/minimal.h"

namespace uplink::config {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using ::uplink::config::testing::ParseWith;

/// The text of the one problem of kMinimal with `more`; empty if there is none.
std::string OneProblem(const std::string& more) {
  const LoadResult result = ParseWith(more);
  EXPECT_LE(result.problems.size(), 1U);
  return result.problems.empty() ? std::string() : ToText(result.problems[0]);
}

TEST(BrokerRelationsTest, WithoutAUrlThereIsNoBroker) {
  const LoadResult result = ParseWith("");
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result.config->mqtt.url, "");
  EXPECT_EQ(result.config->mqtt.client_id, "uplinkd");
  EXPECT_THAT(result.config->cyberwave.topic_prefixes, ElementsAre(""));
}

TEST(BrokerRelationsTest, TheUrlIsThatOfABroker) {
  for (const char* url : {"mqtts://broker.example.org", "mqtt://127.0.0.1:1883", "mqtts://[::1]"}) {
    EXPECT_EQ(OneProblem(std::string("[mqtt]\nurl = \"") + url + "\"\n"), "") << url;
  }
  EXPECT_THAT(OneProblem("[mqtt]\nurl = \"broker:1883\"\n"),
              HasSubstr("u.toml:6: mqtt.url: it begins with neither mqtts:// nor mqtt://"));
  EXPECT_THAT(OneProblem("[mqtt]\nurl = \"mqtt://broker:65536\"\n"),
              HasSubstr("mqtt.url: it has no port from 1 to 65535"));
}

TEST(BrokerRelationsTest, APasswordInTheUrlIsRefusedAndNotRepeated) {
  const std::string problem = OneProblem("[mqtt]\nurl = \"mqtts://me:hunter2@broker\"\n");
  EXPECT_THAT(problem, HasSubstr("mqtt.url: it holds a user: set mqtt.username"));
  EXPECT_THAT(problem, Not(HasSubstr("hunter2")));
}

TEST(BrokerRelationsTest, FilesOfTlsNeedTls) {
  EXPECT_EQ(OneProblem("[mqtt]\nurl = \"mqtts://b\"\nca_file = \"ca.crt\"\n"), "");
  EXPECT_THAT(OneProblem("[mqtt]\nurl = \"mqtt://b\"\nca_file = \"ca.crt\"\n"),
              HasSubstr("mqtt.url: it is mqtt://, which has no TLS"));
}

TEST(BrokerRelationsTest, NotesABrokerOverTheNetworkThatHasNoTls) {
  const auto note = [](const std::string& url, const std::string& more = "") {
    const LoadResult result = ParseWith("[mqtt]\nurl = \"" + url + "\"\n" + more);
    EXPECT_TRUE(result.ok());
    EXPECT_LE(result.notes.size(), 1U);
    return result.notes.empty() ? std::string() : ToText(result.notes[0]);
  };
  EXPECT_THAT(note("mqtt://broker.example.org"),
              AllOf(HasSubstr("u.toml:6: mqtt.url: it is mqtt://, which has no TLS"),
                    HasSubstr("broker.example.org"), HasSubstr("read all topics")));
  EXPECT_THAT(note("mqtt://[2001:db8::1]", "username = \"u\"\npassword_file = \"p\"\n"),
              AllOf(HasSubstr("2001:db8::1"), HasSubstr("read the password")));
  EXPECT_THAT(note("mqtt://127.example.org"), HasSubstr("127.example.org"));
  for (const char* good : {"mqtts://broker.example.org", "mqtt://127.0.0.1", "mqtt://[::1]:1883",
                           "mqtt://localhost", ""}) {
    EXPECT_EQ(note(good), "") << good;
  }
}

TEST(BrokerRelationsTest, ACertificateAndItsKeyAreSetTogether) {
  const std::string certificate = "client_certificate_file = \"c.crt\"\n";
  const std::string key = "client_key_file = \"c.key\"\n";
  EXPECT_EQ(OneProblem("[mqtt]\n" + certificate + key), "");
  EXPECT_THAT(OneProblem("[mqtt]\n" + certificate),
              HasSubstr("mqtt.client_key_file: it is required where mqtt.client_certificate_file"));
  EXPECT_THAT(OneProblem("[mqtt]\n" + key),
              HasSubstr("mqtt.client_certificate_file: it is required where mqtt.client_key_file"));
}

TEST(BrokerRelationsTest, APasswordNeedsAUser) {
  EXPECT_EQ(OneProblem("[mqtt]\nusername = \"u\"\npassword_file = \"p\"\n"), "");
  EXPECT_THAT(OneProblem("[mqtt]\npassword_file = \"p\"\n"),
              HasSubstr("mqtt.password_file: a password needs a user"));
}

TEST(BrokerRelationsTest, AClientIdHasRoomForItsSuffixes) {
  EXPECT_EQ(OneProblem("[mqtt]\nclient_id = \"" + std::string(250, 'c') + "\"\n"), "");
  EXPECT_THAT(OneProblem("[mqtt]\nclient_id = \"" + std::string(251, 'c') + "\"\n"),
              HasSubstr("mqtt.client_id: it has 251 bytes; it must have at most 250"));
  EXPECT_THAT(OneProblem("[mqtt]\nclient_id = \"\"\n"),
              HasSubstr("mqtt.client_id: it is empty; it must be 1 to 250 bytes"));
  for (const char* wrong : {"a\\nb", "a\\tb", "a\\u0007b"}) {
    EXPECT_THAT(OneProblem(std::string("[mqtt]\nclient_id = \"") + wrong + "\"\n"),
                HasSubstr("mqtt.client_id: it holds control characters"))
        << wrong;
  }
}

TEST(BrokerRelationsTest, AUsernameHasALimit) {
  EXPECT_EQ(OneProblem("[mqtt]\nusername = \"" + std::string(1024, 'u') + "\"\n"), "");
  EXPECT_THAT(OneProblem("[mqtt]\nusername = \"" + std::string(1025, 'u') + "\"\n"),
              HasSubstr("mqtt.username: it has 1025 bytes; it must have at most 1024"));
}

TEST(BrokerRelationsTest, ThereAreOneToEightGoodPrefixes) {
  EXPECT_EQ(OneProblem("[cyberwave]\ntopic_prefixes = [\"\", \"a/\", \"local\", \"3\", \"4\", "
                       "\"5\", \"6\", \"7\"]\n"),
            "");
  EXPECT_THAT(OneProblem("[cyberwave]\ntopic_prefixes = [\"1\", \"2\", \"3\", \"4\", \"5\", "
                         "\"6\", \"7\", \"8\", \"9\"]\n"),
              HasSubstr("cyberwave.topic_prefixes: it has 9 prefixes; it must have 1 to 8"));
  EXPECT_THAT(OneProblem("[cyberwave]\ntopic_prefixes = []\n"),
              HasSubstr("it has 0 prefixes; it must have 1 to 8, [\"\"] for none"));
  EXPECT_THAT(OneProblem("[cyberwave]\ntopic_prefixes = [\"a\", \"a\"]\n"),
              HasSubstr("\"a\" stands in it twice"));
  EXPECT_THAT(OneProblem("[cyberwave]\ntopic_prefixes = [\"\", \"\"]\n"),
              HasSubstr("\"\" stands in it twice"));
  EXPECT_THAT(OneProblem("[cyberwave]\ntopic_prefixes = [\"a/#\"]\n"),
              HasSubstr("cyberwave.topic_prefixes: \"a/#\": it holds a wildcard (+, #)"));
  EXPECT_EQ(OneProblem("[cyberwave]\ntopic_prefixes = [\"" + std::string(186, 'p') + "\"]\n"), "");
  EXPECT_THAT(OneProblem("[cyberwave]\ntopic_prefixes = [\"" + std::string(187, 'p') + "\"]\n"),
              HasSubstr("it is too long for a RURI"));
}

TEST(BrokerRelationsTest, ThePrefixesOfTheEnvironmentMayBeEmptyToo) {
  const auto prefixes = [](const char* text) {
    return ParseWith("", {{"UPLINKD_CYBERWAVE_TOPIC_PREFIXES", text}})
        .config->cyberwave.topic_prefixes;
  };
  EXPECT_THAT(prefixes(""), ElementsAre(""));
  EXPECT_THAT(prefixes("a/"), ElementsAre("a/"));
  EXPECT_THAT(prefixes("a/,"), ElementsAre("a/", ""));
  EXPECT_THAT(prefixes(",a/"), ElementsAre("", "a/"));
}

TEST(BrokerRelationsTest, TwinsAreSomeOfTheRobots) {
  EXPECT_EQ(OneProblem("[cyberwave]\nrobots_max = 20000\n"), "");
  EXPECT_THAT(OneProblem("[cyberwave]\nrobots_max = 20001\n"),
              HasSubstr("cyberwave.robots_max: 20001 is over limits.robots_max, 20000"));
}

TEST(BrokerRelationsTest, AServerForFewRobotsHasAsManyTwinsAtMost) {
  const LoadResult few = ParseWith("[limits]\nrobots_max = 500\n");
  ASSERT_TRUE(few.ok());
  EXPECT_EQ(few.config->cyberwave.robots_max, 500U);
  EXPECT_EQ(ParseWith("[limits]\nrobots_max = 10001\n").config->cyberwave.robots_max, 10'000U);
  EXPECT_THAT(ParseWith("[limits]\nrobots_max = 500\n[cyberwave]\nrobots_max = 501\n").problems,
              SizeIs(1));
}

TEST(BrokerRelationsTest, TheFleetIsNamedAsAnother) {
  EXPECT_EQ(OneProblem("[cyberwave]\nfleet = \"" + std::string(256, 'f') + "\"\n"), "");
  EXPECT_THAT(OneProblem("[cyberwave]\nfleet = \"" + std::string(257, 'f') + "\"\n"),
              HasSubstr("cyberwave.fleet: it has 257 bytes, the limit is 256"));
  EXPECT_THAT(OneProblem("[cyberwave]\nfleet = \"\"\n"), HasSubstr("cyberwave.fleet: it is empty"));
  EXPECT_THAT(OneProblem("[cyberwave]\nfleet = \"*\"\n"), HasSubstr("cyberwave.fleet: it is *"));
  EXPECT_THAT(OneProblem("[cyberwave]\nfleet = \"a\\tb\"\n"),
              HasSubstr("cyberwave.fleet: it holds a control character"));
  EXPECT_THAT(OneProblem("[cyberwave]\nfleet = \"a\\u200Bb\"\n"),
              HasSubstr("cyberwave.fleet: it holds U+200B, which is invisible"));
}

}  // namespace
}  // namespace uplink::config
