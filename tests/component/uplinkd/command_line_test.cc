#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "metrics/catalogue.h"
#include "metrics/rcan/series.h"
#include "tests/support/uplinkd_folder.h"

namespace uplink::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct Ended {
  int code = -1;
  std::string text;
};

Ended RunToEnd(const UplinkdFolder& folder, const std::vector<std::string>& arguments,
               const std::vector<std::string>& environment = {}) {
  const auto process = folder.Start(arguments, environment);
  const std::optional<int> code = process->WaitForExit();
  return {code.value_or(-1), process->text()};
}

TEST(CommandLine, CheckConfigIsZeroForAGoodFile) {
  const UplinkdFolder folder;
  const Ended ended = RunToEnd(folder, {"--check-config"});
  EXPECT_EQ(ended.code, 0) << ended.text;
}

TEST(CommandLine, CheckConfigIsTwoAndNamesEveryProblemAtOnce) {
  const UplinkdFolder folder;
  folder.WriteConfig("[presence]\ntimeout = \"soon\"\n[limits]\nno_such_key = 1\n[nonsense]\n");
  const Ended text = RunToEnd(folder, {"--check-config"});
  EXPECT_EQ(text.code, 2);
  EXPECT_THAT(text.text, AllOf(HasSubstr("presence.timeout"), HasSubstr("limits.no_such_key"),
                               HasSubstr("nonsense")));

  folder.WriteConfig();
  folder.Write("server.crt", "no certificate");
  folder.Write("ca.crt", "no certificate");
  const Ended files = RunToEnd(folder, {"--check-config"});
  EXPECT_EQ(files.code, 2);
  EXPECT_THAT(files.text,
              AllOf(HasSubstr("tls.certificate_file"), HasSubstr("tls.client_ca_file")));

  for (const char* name : {"server.crt", "ca.crt"}) std::filesystem::remove(folder.Path(name));
  const Ended missing = RunToEnd(folder, {"--check-config"});
  EXPECT_EQ(missing.code, 2);
  EXPECT_THAT(missing.text,
              AllOf(HasSubstr(folder.Path("server.crt")), HasSubstr(folder.Path("ca.crt"))));
}

TEST(CommandLine, CheckConfigIsTwoForAFileThatIsMissing) {
  const UplinkdFolder folder;
  EXPECT_EQ(RunToEnd(folder, {"--check-config", "--config", folder.Path("none.toml")}).code, 2);
}

TEST(CommandLine, CheckConfigSeesTheEnvironment) {
  const UplinkdFolder folder;
  const Ended ended = RunToEnd(folder, {"--check-config"}, {"UPLINKD_PRESENCE_TIMEOUT=soon"});
  EXPECT_EQ(ended.code, 2);
  EXPECT_THAT(ended.text, HasSubstr("environment: presence.timeout"));
}

TEST(CommandLine, TheVariablesOfAKubernetesServiceAreIgnored) {
  const UplinkdFolder folder;
  const std::vector<std::string> variables = {"UPLINKD_PORT=tcp://10.0.0.7:7443",
                                              "UPLINKD_SERVICE_HOST=10.0.0.7",
                                              "UPLINKD_HTTP_PORT=tcp://10.0.0.8:7480"};
  const Ended ended = RunToEnd(folder, {"--check-config"}, variables);
  EXPECT_EQ(ended.code, 0);
  EXPECT_THAT(ended.text, HasSubstr("note: environment: UPLINKD_PORT, UPLINKD_SERVICE_HOST"));
  const auto server = folder.Start({}, variables);
  EXPECT_TRUE(server->WaitFor(" listening ")) << server->text();
  EXPECT_THAT(server->text(), HasSubstr("warn variables_ignored note="));
}

TEST(CommandLine, AKeyThatEverybodyMayReadIsAWarningAndOneThatTheyMayWriteStopsTheStart) {
  using std::filesystem::perms;
  const UplinkdFolder folder;
  std::filesystem::permissions(folder.Path("server.key"), perms{0644});
  const Ended checked = RunToEnd(folder, {"--check-config"});
  EXPECT_EQ(checked.code, 0);
  EXPECT_THAT(checked.text, AllOf(HasSubstr("note: "), HasSubstr("tls.key_file")));
  const auto server = folder.Start();
  EXPECT_TRUE(server->WaitFor(" listening ")) << server->text();
  EXPECT_THAT(server->text(), HasSubstr("warn secret_readable note="));

  std::filesystem::permissions(folder.Path("server.key"), perms{0646});
  for (const Ended& ended : {RunToEnd(folder, {"--check-config"}), RunToEnd(folder, {})}) {
    EXPECT_EQ(ended.code, 2);
    EXPECT_THAT(ended.text, AllOf(HasSubstr("tls.key_file"), HasSubstr(folder.Path("server.key")),
                                  HasSubstr("0646")));
  }
}

TEST(CommandLine, CheckConfigNotesADatabaseThatNeedNotProveWhoItIs) {
  const UplinkdFolder folder;
  const std::string url = "UPLINKD_STORE_URL=postgresql://u@db.example.org/d";
  const Ended noted = RunToEnd(folder, {"--check-config"}, {url, "PGSSLMODE=verify-ca"});
  EXPECT_EQ(noted.code, 0);
  EXPECT_THAT(noted.text, HasSubstr("note: environment: store.url: sslmode is verify-ca"));
  // As libpq itself reads it.
  const Ended good = RunToEnd(folder, {"--check-config"}, {url, "PGSSLMODE=verify-full"});
  EXPECT_EQ(good.code, 0);
  EXPECT_THAT(good.text, Not(HasSubstr("sslmode")));
}

TEST(CommandLine, PrintConfigShowsWhatIsEffective) {
  const UplinkdFolder folder;
  const Ended ended = RunToEnd(folder, {"--print-config"}, {"UPLINKD_PRESENCE_TIMEOUT=11s"});
  EXPECT_EQ(ended.code, 0);
  EXPECT_THAT(ended.text, HasSubstr("timeout = \"11s\""));
}

TEST(CommandLine, PrintMetricsIsTheCatalogue) {
  const UplinkdFolder folder;
  const Ended ended = RunToEnd(folder, {"--print-metrics"});
  EXPECT_EQ(ended.code, 0);
  EXPECT_EQ(ended.text, metrics::CatalogueTable() + "\n" + metrics::rcan::SeriesTable("acb"));
}

TEST(CommandLine, VersionIsOneLine) {
  const UplinkdFolder folder;
  const Ended ended = RunToEnd(folder, {"--version"});
  EXPECT_EQ(ended.code, 0);
  EXPECT_THAT(ended.text, ::testing::MatchesRegex(
                              "uplinkd [0-9]+\\.[0-9]+\\.[0-9]+ \\(commit [0-9A-Za-z]+\\)\n"));
}

TEST(CommandLine, WrongUseIsTwo) {
  const UplinkdFolder folder;
  EXPECT_EQ(RunToEnd(folder, {"--no-such-flag"}).code, 2);
  const Ended near = RunToEnd(folder, {"--confg", folder.Path("uplinkd.toml")});
  EXPECT_EQ(near.code, 2);
  EXPECT_EQ(near.text, "uplinkd: --confg: unknown flag; did you mean --config?\n");
  EXPECT_EQ(RunToEnd(folder, {"--check-config", "--print-config"}).code, 2);
}

TEST(CommandLine, ABadConfigurationStopsTheStartWithTwo) {
  const UplinkdFolder folder;
  folder.WriteConfig("[limits]\nrobots_max = 0\n");
  const Ended ended = RunToEnd(folder, {});
  EXPECT_EQ(ended.code, 2);
  EXPECT_THAT(ended.text, HasSubstr("limits.robots_max"));
}

TEST(CommandLine, ATransportInTheFileOrTheEnvironmentIsTwoAndSaysWhatToDo) {
  const std::string text = "removed; there is only one transport now: ";
  const std::vector<std::string> check = {"--check-config"};
  const std::vector<std::string> serve = {};
  for (const std::string value : {"grpc", "native"}) {
    const UplinkdFolder folder;
    for (const auto& flags : {check, serve}) {
      const Ended ended = RunToEnd(folder, flags, {"UPLINKD_LISTEN_TRANSPORT=" + value});
      EXPECT_EQ(ended.code, 2);
      EXPECT_EQ(ended.text, "uplinkd: environment: UPLINKD_LISTEN_TRANSPORT: " + text +
                                "unset this variable\n");
    }
    folder.Write("uplinkd.toml", "[listen]\ntransport = \"" + value + "\"\n");
    for (const auto& flags : {check, serve}) {
      const Ended ended = RunToEnd(folder, flags);
      EXPECT_EQ(ended.code, 2);
      EXPECT_THAT(ended.text,
                  HasSubstr("uplinkd.toml:2: listen.transport: " + text + "delete this line\n"));
    }
  }
}

}  // namespace
}  // namespace uplink::testing
