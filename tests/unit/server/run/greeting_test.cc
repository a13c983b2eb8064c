#include "server/run/greeting.h"

#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include "server/identity/expiry.h"
#include "tests/support/certificates.h"
#include "tests/support/kept_lines.h"

namespace uplink::run {
namespace {

using std::chrono::days;
using std::chrono::hours;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::Not;
using ::testing::StartsWith;

constexpr SystemTime kNow = FromUnixMs(1'700'000'000'000);

Ready SomeReady() {
  return {.store = "/var/lib/uplinkd/uplinkd.db",
          .robots = 1,
          .relay = {"::", 7443},
          .http = {"127.0.0.1", 7480}};
}

TEST(CertificateTextTest, NamesHostsAndWhatIsLeft) {
  EXPECT_EQ(CertificateText({{"localhost", "127.0.0.1"}, kNow + days(2) + hours(23)}, kNow),
            "localhost, 127.0.0.1; 2 days left, until 2023-11-17T21:13:20Z");
  EXPECT_EQ(CertificateText({{"a"}, kNow + days(1)}, kNow),
            "a; 1 day left, until 2023-11-15T22:13:20Z");
  EXPECT_THAT(CertificateText({{"a"}, kNow + hours(5)}, kNow), HasSubstr("; 5 hours left"));
  EXPECT_EQ(CertificateText({{"a"}, kNow}, kNow), "a; EXPIRED at 2023-11-14T22:13:20Z");
  EXPECT_EQ(CertificateText({{"a"}, identity::kNoExpiry}, kNow), "a; never expires");
}

TEST(CertificateTextTest, CountsTheHostsThatItLeavesOut) {
  std::vector<std::string> hosts(kHostsShownMax, "a");
  EXPECT_THAT(CertificateText({hosts, kNow}, kNow), StartsWith("a, a, a; "));
  hosts.emplace_back("b");
  EXPECT_THAT(CertificateText({hosts, kNow}, kNow), StartsWith("a, a, a and 1 more; "));
  EXPECT_THAT(CertificateText({{}, kNow}, kNow), StartsWith("names no host"));
}

TEST(CertificateTextTest, ShowsNoControlCharacters) {
  EXPECT_THAT(CertificateText({{"a\x1b[2Jb"}, kNow}, kNow), StartsWith("a\\x1b[2Jb;"));
}

TEST(ReadyLinesTest, AreFiveWithoutBrokerAndDrones) {
  EXPECT_THAT(ReadyLines({}, SomeReady(), "localhost; 364 days left"),
              ElementsAre("  store   /var/lib/uplinkd/uplinkd.db, 1 robot known",
                          "  robots  [::]:7443, gRPC with mutual TLS",
                          "  http    http://127.0.0.1:7480: API, metrics, health",
                          "  TLS     localhost; 364 days left",
                          "  next    curl http://127.0.0.1:7480/api/v1/robots   (Ctrl-C drains "
                          "and stops)"));
}

TEST(ReadyLinesTest, SayHowToAskWhereCallersShowWhoTheyAre) {
  config::Config config;
  config.http.tls_certificate_file = "http.crt";
  EXPECT_THAT(
      ReadyLines(config, SomeReady(), ""),
      IsSupersetOf({"  http    https://127.0.0.1:7480: API, metrics, health, to those who "
                    "show who they are",
                    "  next    uplinkctl pki operator --help   (Ctrl-C drains and stops)"}));
  config.http.tokens_file = "/etc/uplinkd/tokens";
  Ready ready = SomeReady();
  ready.metrics = {"::", 9464};
  EXPECT_THAT(ReadyLines(config, ready, ""),
              IsSupersetOf({"  metrics http://[::]:9464: probes and scrapes, with authentication",
                            "  next    uplinkctl tokens new --help   (Ctrl-C drains and stops)"}));
}

TEST(ReadyLinesTest, NameTheSocketOfHttp) {
  Ready ready = SomeReady();
  ready.http = {.path = "/run/uplinkd/http.sock"};
  EXPECT_THAT(ReadyLines({}, ready, ""),
              IsSupersetOf({"  http    unix:/run/uplinkd/http.sock: API, metrics, health",
                            "  next    curl --unix-socket /run/uplinkd/http.sock "
                            "http://localhost/api/v1/robots   (Ctrl-C drains and stops)"}));
}

TEST(ReadyLinesTest, TellOfABrokerAndDronesWhereTheyAreSet) {
  config::Config config;
  config.uncrew.avatar = true;
  config.mqtt.url = "mqtts://broker.example.org";
  config.mqtt.username = "secret-user";
  config.mqtt.password_file = "/secret/file";
  const std::vector<std::string> lines = ReadyLines(config, SomeReady(), "");
  EXPECT_THAT(lines, IsSupersetOf({"  drones  at the same address, AvatarService",
                                   "  broker  mqtts://broker.example.org:8883, MQTT"}));
  for (const std::string& line : lines) EXPECT_THAT(line, Not(HasSubstr("secret")));
}

TEST(ReadyLinesTest, TellOfTheListenerForMetricsWhereItIsSet) {
  Ready ready = SomeReady();
  ready.metrics = {"0.0.0.0", 9464};
  const std::vector<std::string> lines = ReadyLines({}, ready, "");
  ASSERT_EQ(lines.size(), 6U);
  EXPECT_EQ(lines[3], "  metrics http://0.0.0.0:9464: probes and scrapes, without authentication");
}

TEST(ReadyLinesTest, SayThatRobotsAreNotReadYet) {
  Ready ready = SomeReady();
  ready.robots_unread = true;
  EXPECT_THAT(ReadyLines({}, ready, "").front(), HasSubstr(", its robots are not read yet"));
}

/// A greeting on a terminal of the test's own.
class GreetingTest : public ::testing::Test {
 protected:
  GreetingTest() {
    grantpt(master_);
    unlockpt(master_);
    std::array<char, 64> name{};
    EXPECT_EQ(ptsname_r(master_, name.data(), name.size()), 0);
    terminal_ = open(name.data(), O_RDWR | O_NOCTTY);
    const auto path = std::filesystem::path(::testing::TempDir()) / "greeting.crt";
    config_.store.url = "sqlite:///s/u.db";
    config_.tls.certificate_file = path.string();
    std::ofstream(path) << testing::TestAuthority().Issue(testing::ServerSpec()).certificate;
  }
  ~GreetingTest() override {
    close(terminal_);
    close(master_);
  }

  /// A start that logs one info event and one warning on its way, and then does `end`.
  void BeginOn(int descriptor, const std::function<void(log::Logger&, Greeting&)>& end) {
    log::Logger logger(std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                       log::Level::kInfo);
    Greeting greeting({logger, config_, "u.toml", clock_, descriptor});
    greeting.Begin();
    logger.Info("store_opening");
    logger.Warn("store_unsafe");
    end(logger, greeting);
  }
  void StartOn(int descriptor) {
    BeginOn(descriptor, [](log::Logger& logger, Greeting& greeting) {
      greeting.TellReady(SomeReady());
      greeting.End();
      logger.Info("draining");
    });
  }

  config::Config config_;
  const SystemClock clock_;
  std::vector<std::string> lines_;
  const int master_ = posix_openpt(O_RDWR | O_NOCTTY);
  int terminal_ = -1;
};

TEST_F(GreetingTest, ReplacesTheInfoEventsOfTheStartOnATerminal) {
  StartOn(terminal_);
  EXPECT_THAT(lines_, ElementsAre(StartsWith("uplinkd "), StartsWith("  store   "),
                                  StartsWith("  robots  "), StartsWith("  http    "),
                                  StartsWith("  TLS     localhost"), StartsWith("  next    curl "),
                                  HasSubstr(" warn store_unsafe"), HasSubstr(" info draining")));
  EXPECT_THAT(lines_.front(), HasSubstr(" starts with u.toml, store /s/u.db"));
}

TEST_F(GreetingTest, TellsWhyTheStartFailed) {
  BeginOn(terminal_, [](log::Logger& logger, Greeting& greeting) {
    greeting.TellFailed(absl::UnavailableError("the port is taken: set a free one\x1b[2J"));
    logger.Info("stopped");
  });
  EXPECT_THAT(lines_, ElementsAre(StartsWith("uplinkd "), HasSubstr(" warn store_unsafe"),
                                  "uplinkd: the port is taken: set a free one\\x1b[2J"));
}

TEST_F(GreetingTest, TellsThatASignalEndedTheStart) {
  BeginOn(terminal_,
          [](log::Logger& /*logger*/, Greeting& greeting) { greeting.TellStopped(SIGINT); });
  EXPECT_THAT(lines_, ElementsAre(StartsWith("uplinkd "), HasSubstr(" warn store_unsafe"),
                                  "uplinkd: stopped before it was ready"));
}

TEST_F(GreetingTest, ElsewhereBothAreEvents) {
  const auto end = [](log::Logger& /*logger*/, Greeting& greeting) {
    greeting.TellFailed(absl::UnavailableError("no store"));
    greeting.TellStopped(SIGINT);
  };
  config_.log.format = config::LogFormat::kJson;
  BeginOn(terminal_, end);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("store_opening"), HasSubstr("store_unsafe"),
                                  HasSubstr(" error start_failed error=\"no store\""),
                                  HasSubstr(" info stopped_while_starting signal=2")));
}

TEST_F(GreetingTest, LeavesALevelThatAReloadSetMeanwhile) {
  BeginOn(terminal_, [](log::Logger& logger, Greeting& greeting) {
    logger.SetLevel(log::Level::kDebug);
    logger.Info("reloaded");
    greeting.TellReady(SomeReady());
    greeting.End();
    logger.Debug("connection_came");
    logger.SetLevel(log::Level::kError);
    greeting.End();
    logger.Warn("store_away");
  });
  ASSERT_FALSE(lines_.empty());
  EXPECT_THAT(lines_.back(), HasSubstr(" debug connection_came"));
  for (const std::string& line : lines_) EXPECT_THAT(line, Not(HasSubstr("reloaded")));
}

TEST_F(GreetingTest, NamesADatabaseBeforeItAnswers) {
  config_.store.url = "postgresql://uplinkd@db.example.org/fleet";
  StartOn(terminal_);
  EXPECT_THAT(lines_.front(), HasSubstr(" starts with u.toml, store db.example.org:5432/fleet"));
}

TEST_F(GreetingTest, SaysNothingElsewhere) {
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  StartOn(nowhere);
  close(nowhere);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("store_opening"), HasSubstr("store_unsafe"),
                                  HasSubstr("draining")));
}

TEST_F(GreetingTest, SaysNothingWhereTheLogIsSetOtherwise) {
  config_.log.format = config::LogFormat::kJson;
  StartOn(terminal_);
  EXPECT_THAT(lines_, Not(IsEmpty()));
  config_.log.format = config::LogFormat::kText;
  for (const auto level :
       {config::LogLevel::kDebug, config::LogLevel::kWarn, config::LogLevel::kError}) {
    config_.log.level = level;
    StartOn(terminal_);
  }
  for (const std::string& line : lines_) EXPECT_THAT(line, Not(HasSubstr("next")));
}

}  // namespace
}  // namespace uplink::run
