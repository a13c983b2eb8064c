#include "server/config/load.h"

#include <cstdio>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "server/config/service_variables.h"
#include "server/config/settings.h"
#include "tests/unit/server/config/minimal.h"

namespace uplink::config {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using ::uplink::config::testing::kMinimal;
using ::uplink::config::testing::ParseWith;

auto IsProblem(const std::string& where, const std::string& key, const std::string& part) {
  return AllOf(Field("where", &Problem::where, where), Field("key", &Problem::key, key),
               Field("text", &Problem::text, HasSubstr(part)));
}

TEST(ParseConfigTest, TakesTheMinimumAndKeepsTheDefaults) {
  const LoadResult result = ParseWith("");
  ASSERT_THAT(result.problems, IsEmpty());
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result.config->tls.key_file, "s.key");
  EXPECT_EQ(result.config->limits.frame_bytes_max, 1 * kMiB);
  EXPECT_EQ(result.config->presence.timeout, milliseconds(10'000));
}

TEST(ParseConfigTest, ReadsEveryKindOfValue) {
  const LoadResult result = ParseWith(
      "[listen]\nrelay = \"127.0.0.1:0\"\n[limits]\nrobots_max = 7\nframe_bytes_max = \"2MiB\"\n"
      "ack_interval = \"250ms\"\n[store]\nmigrate = false\nurl = \"sqlite:///a b/c.db\"\n[log]\n"
      "format = \"json\"\nlevel = \"debug\"\n[drain]\ntimeout = \"1s\"\n");
  ASSERT_THAT(result.problems, IsEmpty());
  EXPECT_EQ(result.config->listen.relay, (ListenAddress{"127.0.0.1", 0}));
  EXPECT_EQ(result.config->limits.robots_max, 7U);
  EXPECT_EQ(result.config->limits.frame_bytes_max, 2 * kMiB);
  EXPECT_EQ(result.config->limits.ack_interval, milliseconds(250));
  EXPECT_FALSE(result.config->store.migrate);
  EXPECT_EQ(SqlitePath(result.config->store), "/a b/c.db");
  EXPECT_EQ(result.config->log.format, LogFormat::kJson);
  EXPECT_EQ(result.config->log.level, LogLevel::kDebug);
}

TEST(ParseConfigTest, ReportsEveryProblemAtOnceInTheOrderOfTheFile) {
  const LoadResult result = ParseWith(
      "min_version = \"1.1\"\n[presence]\ntimeout = 10\n[limits]\nrobots_max = 0\n"
      "robot_max = 5\n[ratios]\n[journal]\nbytes_max = \"1KB\"\n");
  EXPECT_FALSE(result.ok());
  EXPECT_THAT(
      result.problems,
      ElementsAre(IsProblem("u.toml:5", "tls.min_version", "\"1.1\" is not allowed"),
                  IsProblem("u.toml:7", "presence.timeout", "a duration"),
                  IsProblem("u.toml:9", "limits.robots_max", "0 is not allowed"),
                  IsProblem("u.toml:10", "limits.robot_max", "did you mean limits.robots_max?"),
                  IsProblem("u.toml:11", "ratios", "unknown section"),
                  IsProblem("u.toml:13", "journal.bytes_max", "\"1KB\" is not allowed")));
}

TEST(ParseConfigTest, NamesValueAndLimitOfAnOutOfBoundsNumber) {
  const LoadResult result = ParseWith("[limits]\nrobots_max = 1000001\n");
  ASSERT_THAT(result.problems, SizeIs(1));
  EXPECT_EQ(ToText(result.problems[0]),
            "u.toml:6: limits.robots_max: 1000001 is not allowed; it must be a whole number from 1 "
            "to 1000000");
}

TEST(ParseConfigTest, ANumberOrSwitchInQuotesIsToldHowToBeWritten) {
  const LoadResult result = ParseWith(
      "[limits]\nrobots_max = \"100\"\ngateway_streams_max = \"many\"\n[store]\n"
      "migrate = \"false\"\n");
  ASSERT_THAT(result.problems, SizeIs(3));
  EXPECT_EQ(
      ToText(result.problems[0]),
      "u.toml:6: limits.robots_max: it stands in quotes: write robots_max = 100; it must be a "
      "whole number from 1 to 1000000");
  EXPECT_EQ(ToText(result.problems[1]),
            "u.toml:7: limits.gateway_streams_max: it must be a whole number from 1 to 4096");
  EXPECT_EQ(ToText(result.problems[2]),
            "u.toml:9: store.migrate: it stands in quotes: write migrate = false; it must be true "
            "or false");
}

TEST(ParseConfigTest, StreamsOfAGatewaysConnectionHaveTheirBounds) {
  const auto with = [](const std::string& number) {
    return ParseWith("[limits]\ngateway_streams_max = " + number + "\n");
  };
  EXPECT_EQ(with("1").config->limits.gateway_streams_max, 1U);
  EXPECT_EQ(with("4096").config->limits.gateway_streams_max, 4'096U);
  for (const char* const bad : {"0", "4097"}) {
    EXPECT_THAT(with(bad).problems,
                ElementsAre(IsProblem("u.toml:6", "limits.gateway_streams_max", "from 1 to 4096")))
        << bad;
  }
}

TEST(ParseConfigTest, RefusesAValueOfTheWrongType) {
  for (const char* const line :
       {"[store]\nmigrate = \"true\"\n", "[store]\nmigrate = 1\n", "[limits]\nrobots_max = \"5\"\n",
        "[limits]\nrobots_max = 5.0\n", "[limits]\nrobots_max = -5\n", "[log]\nlevel = 3\n",
        "[limits]\nframe_bytes_max = 1048576\n", "[log]\nlevel = [\"info\"]\n"}) {
    EXPECT_THAT(ParseWith(line).problems, SizeIs(1)) << line;
  }
}

TEST(ParseConfigTest, RefusesAKeyOutsideItsSection) {
  EXPECT_THAT(ParseConfig("robots_max = 5\n" + std::string(kMinimal), "u.toml", {}).problems,
              ElementsAre(IsProblem("u.toml:1", "robots_max", "such as [limits]")));
}

TEST(ParseConfigTest, RefusesASectionThatIsNoTable) {
  EXPECT_THAT(ParseConfig("limits = 5\n" + std::string(kMinimal), "u.toml", {}).problems,
              ElementsAre(IsProblem("u.toml:1", "limits", "write [limits]")));
}

TEST(ParseConfigTest, ReportsTextThatIsNoTomlWithItsLineAlone) {
  EXPECT_THAT(ParseConfig("[tls]\nkey_file =\n", "u.toml", {}).problems, SizeIs(1));
  EXPECT_EQ(ParseConfig("[tls]\nkey_file = = 1\n", "u.toml", {}).problems[0].where, "u.toml:2");
}

TEST(ParseConfigTest, RefusesAKeyThatStandsTwice) {
  EXPECT_THAT(ParseWith("key_file = \"again\"\n").problems, SizeIs(1));
}

TEST(ParseConfigTest, LaysTheEnvironmentOverTheFile) {
  const LoadResult result =
      ParseWith("[limits]\nrobots_max = 5\n", {{"UPLINKD_LIMITS_ROBOTS_MAX", "6"},
                                               {"UPLINKD_STORE_MIGRATE", "false"},
                                               {"UPLINKD_PRESENCE_TIMEOUT", "3s"}});
  ASSERT_THAT(result.problems, IsEmpty());
  EXPECT_EQ(result.config->limits.robots_max, 6U);
  EXPECT_FALSE(result.config->store.migrate);
  EXPECT_EQ(result.config->presence.timeout, milliseconds(3000));
}

TEST(ParseConfigTest, ReportsWhatTheEnvironmentHasWrong) {
  const LoadResult result = ParseWith(
      "", {{"UPLINKD_LIMITS_ROBOTS_MAX", "many"}, {"UPLINKD_NO_SUCH", "1"}, {"UPLINKD_X", ""}});
  EXPECT_THAT(result.problems,
              ElementsAre(IsProblem("environment", "limits.robots_max", "\"many\" is not allowed"),
                          IsProblem("environment", "UPLINKD_NO_SUCH", "no key has this variable"),
                          IsProblem("environment", "UPLINKD_X", "no key has this variable")));
}

// What Kubernetes sets in each container where a Service is named uplinkd.
TEST(ParseConfigTest, IgnoresTheVariablesOfAServiceThatIsNamedUplinkdInOneNote) {
  const LoadResult result = ParseWith("", {{"UPLINKD_PORT", "tcp://10.0.0.7:7443"},
                                           {"UPLINKD_LIMITS_ROBOTS_MAX", "6"},
                                           {"UPLINKD_PORT_7443_TCP", "tcp://10.0.0.7:7443"},
                                           {"UPLINKD_PORT_7443_TCP_ADDR", "10.0.0.7"},
                                           {"UPLINKD_SERVICE_HOST", "10.0.0.7"},
                                           {"UPLINKD_SERVICE_PORT_RELAY", "7443"}});
  ASSERT_THAT(result.problems, IsEmpty());
  EXPECT_EQ(result.config->limits.robots_max, 6U);
  EXPECT_THAT(result.notes,
              ElementsAre(IsProblem("environment", "", "UPLINKD_PORT, UPLINKD_PORT_7443_TCP")));
  EXPECT_THAT(result.notes, ElementsAre(IsProblem("environment", "", "and 2 more")));
}

// A Service's further ports, and Services of parts of it.
TEST(ParseConfigTest, IgnoresTheVariablesOfServicesWhoseNamesBeginWithUplinkd) {
  const LoadResult result = ParseWith("", {{"UPLINKD_HTTP_SERVICE_HOST", "10.0.0.8"},
                                           {"UPLINKD_HTTP_SERVICE_PORT", "7480"},
                                           {"UPLINKD_HTTP_SERVICE_PORT_API", "7480"},
                                           {"UPLINKD_HTTP_PORT", "tcp://10.0.0.8:7480"},
                                           {"UPLINKD_HTTP_PORT_7480_TCP", "tcp://10.0.0.8:7480"},
                                           {"UPLINKD_HTTP_PORT_7480_TCP_PROTO", "tcp"},
                                           {"UPLINKD_HTTP_PORT_7480_TCP_PORT", "7480"},
                                           {"UPLINKD_HTTP_PORT_7480_TCP_ADDR", "10.0.0.8"},
                                           {"UPLINKD_A_PORT_B_PORT", "udp://10.0.0.8:53"},
                                           {"UPLINKD_A_PORT_B_PORT_53_UDP", "udp://10.0.0.8:53"},
                                           {"UPLINKD_LIMITS_ROBOTS_MAX", "6"}});
  ASSERT_THAT(result.problems, IsEmpty());
  EXPECT_EQ(result.config->limits.robots_max, 6U);
  EXPECT_THAT(result.notes, ElementsAre(IsProblem("environment", "", "and 7 more")));
}

TEST(ParseConfigTest, AVariableThatLooksLikeThoseOfAServiceIsAnError) {
  const Environment variables = {{"UPLINKD_HTTP_PORT", "7480"},
                                 {"UPLINKD_HTTP_PORT_7480_TCP", "7480"},
                                 {"UPLINKD_HTTP_PORT_7480_TCP_MAX", "tcp://10.0.0.8:7480"},
                                 {"UPLINKD_HTTP_PORT_7480_TCPX", "tcp://10.0.0.8:7480"},
                                 {"UPLINKD_HTTP_PORT__TCP", "tcp://10.0.0.8:7480"},
                                 {"UPLINKD_HTTP_PORTS", "tcp://10.0.0.8:7480"},
                                 {"UPLINKD_HTTP_SERVICE_HOSTS", "10.0.0.8"}};
  const LoadResult result = ParseWith("", variables);
  EXPECT_THAT(result.problems, SizeIs(variables.size()));
  EXPECT_THAT(result.notes, IsEmpty());
}

TEST(ParseConfigTest, AVariableThatOnlyBeginsAsThoseOfAServiceIsAnError) {
  const LoadResult result =
      ParseWith("", {{"UPLINKD_PORTS", "1"}, {"UPLINKD_SERVICE", "1"}, {"UPLINKD_X_PORT", "1"}});
  EXPECT_THAT(result.problems, SizeIs(3));
  EXPECT_THAT(result.notes, IsEmpty());
}

TEST(ParseConfigTest, NoKeyHasTheNameOfAServicesVariable) {
  for (const Setting& setting : Settings()) {
    const std::string name = EnvironmentName(setting) + "_";
    EXPECT_FALSE(name.starts_with("UPLINKD_PORT_") || name.starts_with("UPLINKD_SERVICE_")) << name;
    EXPECT_FALSE(IsServiceVariable(EnvironmentName(setting), "tcp://10.0.0.8:7480")) << name;
  }
}

std::string NoteOfUrl(const std::string& url) {
  const LoadResult result = ParseWith("[store]\nurl = \"" + url + "\"\n");
  EXPECT_THAT(result.problems, IsEmpty()) << url;
  return result.notes.empty() ? std::string() : ToText(result.notes.front());
}

TEST(ParseConfigTest, NotesADatabaseOverTheNetworkThatNeedNotProveWhoItIs) {
  const std::string remote = "postgresql://u@db.example.org/d?sslmode=";
  for (const std::string mode : {"disable", "allow", "prefer", "require", "verify-ca"}) {
    EXPECT_THAT(
        NoteOfUrl(remote + mode),
        AllOf(HasSubstr("u.toml:6: store.url: sslmode is " + mode), HasSubstr("db.example.org")));
  }
  EXPECT_EQ(NoteOfUrl(remote + "verify-full"), "");
  EXPECT_THAT(NoteOfUrl("postgresql://u@localhost,192.0.2.7/d?sslmode=require"),
              HasSubstr("192.0.2.7"));
  EXPECT_THAT(NoteOfUrl("postgresql://u@localhost/d?hostaddr=192.0.2.7&sslmode=require"),
              HasSubstr("192.0.2.7"));
  EXPECT_THAT(NoteOfUrl("postgresql://u@[2001:db8::1]/d?sslmode=require"),
              HasSubstr("2001:db8::1"));
}

TEST(ParseConfigTest, ADatabaseOfThisMachineNeedNotProveWhoItIs) {
  for (const char* place :
       {"/d?host=/run/postgresql&", "%2Frun%2Fpostgresql/d?", "localhost/d?", "127.0.0.2:5433/d?",
        "[::1]/d?", "127.0.0.1,localhost/d?", "db/d?hostaddr=127.0.0.1&"}) {
    EXPECT_EQ(NoteOfUrl(std::string("postgresql://u@") + place + "sslmode=disable"), "") << place;
  }
}

TEST(ParseConfigTest, ReadsListsFromTheFileAndTheEnvironment) {
  const LoadResult result =
      ParseWith("[rcan]\nfields = [\"robot_online\", \"acb_effort_nm\"]\nfleets = []\n",
                {{"UPLINKD_RCAN_EXTRAS", "rpm,oil temp"}});
  ASSERT_TRUE(result.ok());
  EXPECT_THAT(result.config->rcan.fields, ElementsAre("robot_online", "acb_effort_nm"));
  EXPECT_THAT(result.config->rcan.fleets, IsEmpty());
  EXPECT_THAT(result.config->rcan.extras, ElementsAre("rpm", "oil temp"));
  EXPECT_THAT(PrintConfig(*result.config),
              HasSubstr("fields = [\"robot_online\", \"acb_effort_nm\"]"));
  EXPECT_TRUE(ParseWith("", {{"UPLINKD_RCAN_EXTRAS", ""}}).config->rcan.extras.empty());
}

TEST(ParseConfigTest, RefusesListsThatAreNone) {
  for (const char* wrong : {"\"a\"", "[1]", "[\"\"]", "[[\"a\"]]", "{}"}) {
    const LoadResult result = ParseWith(std::string("[rcan]\nfields = ") + wrong + "\n");
    EXPECT_THAT(result.problems,
                ElementsAre(IsProblem("u.toml:6", "rcan.fields", "256 strings of 1 to 256 bytes")))
        << wrong;
  }
  EXPECT_THAT(ParseWith("[rcan]\nextras = [\"rpm\", \"x\", \"rpm\"]\n").problems,
              ElementsAre(IsProblem("u.toml:6", "rcan.extras", "\"rpm\" stands in it twice")));
  std::string many;
  for (int i = 0; i < 257; ++i) many += "\"x\",";
  EXPECT_THAT(ParseWith("[rcan]\nfleets = [" + many + "]\n").problems,
              ElementsAre(IsProblem("u.toml:6", "rcan.fleets", "257 strings")));
}

TEST(ParseConfigTest, ARemovedKeySaysWhatToDo) {
  for (const char* const value : {"\"grpc\"", "\"native\"", "1"}) {
    const LoadResult file = ParseWith(std::string("[listen]\ntransport = ") + value + "\n");
    EXPECT_FALSE(file.ok());
    EXPECT_THAT(file.problems, ElementsAre(IsProblem("u.toml:6", "listen.transport",
                                                     "removed; there is only one transport now: "
                                                     "delete this line")))
        << value;
  }
  for (const char* const value : {"grpc", "native", ""}) {
    const LoadResult variable = ParseWith("", {{"UPLINKD_LISTEN_TRANSPORT", value}});
    EXPECT_FALSE(variable.ok());
    EXPECT_THAT(variable.problems,
                ElementsAre(IsProblem("environment", "UPLINKD_LISTEN_TRANSPORT",
                                      "removed; there is only one transport now: "
                                      "unset this variable")))
        << value;
  }
}

TEST(ParseConfigTest, TakesTheKeysOfPresenceThatWereRemovedOnce) {
  const LoadResult result =
      ParseWith("[presence]\nflap_changes = 4\nflap_window = \"1m\"\nparked_max = \"1d\"\n");
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result.config->presence.flap_changes, 4U);
  EXPECT_EQ(result.config->presence.flap_window, std::chrono::minutes(1));
  EXPECT_EQ(result.config->presence.parked_max, std::chrono::days(1));
  EXPECT_EQ(ParseWith("[presence]\nflap_changes = 101\n").problems.size(), 1U);
  EXPECT_EQ(ParseWith("[presence]\nparked_max = \"8d\"\n").problems.size(), 1U);
}

TEST(ParseConfigTest, OperatorsHaveNoListenerUnlessTheyAskForOne) {
  EXPECT_FALSE(IsSet(ParseWith("").config->listen.fleet));
  const LoadResult result = ParseWith("[listen]\nfleet = \"127.0.0.1:9\"\n");
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result.config->listen.fleet.port, 9);
  EXPECT_THAT(result.notes, IsEmpty());
  EXPECT_EQ(ParseWith("[listen]\nfleet = \"[::]:7443\"\n").problems.size(), 1U)
      << "the relay is there";
}

TEST(PrintConfigTest, ReadsBackToTheSameConfiguration) {
  const LoadResult first = ParseWith(
      "operator_ca_file = \"q\\\"\\\\\\u0001.crt\"\nmin_version = \"1.3\"\n[limits]\n"
      "session_idle = \"90s\"\n");
  ASSERT_THAT(first.problems, IsEmpty());
  const std::string printed = PrintConfig(*first.config);
  const LoadResult second = ParseConfig(printed, "printed", {});
  ASSERT_THAT(second.problems, IsEmpty());
  EXPECT_EQ(PrintConfig(*second.config), printed);
  EXPECT_EQ(second.config->tls.operator_ca_file, first.config->tls.operator_ca_file);
  EXPECT_EQ(second.config->tls.min_version, TlsVersion::k13);
}

TEST(LoadConfigTest, ReadsAFileAndNamesItInProblems) {
  const std::string path = ::testing::TempDir() + "uplinkd_load_test.toml";
  std::ofstream(path) << kMinimal << "[limits]\nnope = 1\n";
  EXPECT_THAT(LoadConfig(path, {}).problems,
              ElementsAre(IsProblem(path + ":6", "limits.nope", "unknown key")));
  EXPECT_EQ(std::remove(path.c_str()), 0);
}

TEST(LoadConfigTest, ReadsFilesUpToTheBoundAndNotPastIt) {
  const std::string path = ::testing::TempDir() + "uplinkd_load_size_test.toml";
  std::string text(kMinimal);
  text += "#" + std::string(kConfigBytesMax - text.size() - 1, 'x');
  std::ofstream(path) << text;
  EXPECT_TRUE(LoadConfig(path, {}).ok());
  std::ofstream(path) << text << "x";
  EXPECT_THAT(LoadConfig(path, {}).problems, ElementsAre(IsProblem(path, "", "larger than")));
  EXPECT_EQ(std::remove(path.c_str()), 0);
}

TEST(LoadConfigTest, ReportsAFileThatIsNotThereOrAFolder) {
  EXPECT_THAT(LoadConfig("/no/such/file.toml", {}).problems,
              ElementsAre(IsProblem("/no/such/file.toml", "",
                                    "cannot be read: No such file or directory; correct")));
  EXPECT_THAT(LoadConfig("/", {}).problems, ElementsAre(IsProblem("/", "", "cannot be read")));
}

TEST(LoadConfigTest, ReportsWhatIsNoRegularFileAndDoesNotWaitForAPipe) {
  EXPECT_THAT(LoadConfig("/dev/null", {}).problems,
              ElementsAre(IsProblem("/dev/null", "", "is not a regular file; name one")));
  const std::string path = ::testing::TempDir() + "uplinkd_load_pipe_test.toml";
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  EXPECT_THAT(LoadConfig(path, {}).problems,
              ElementsAre(IsProblem(path, "", "is not a regular file; name one")));
  EXPECT_EQ(std::remove(path.c_str()), 0);
}

}  // namespace
}  // namespace uplink::config
