#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <span>
#include <sstream>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include "schema/base/check.h"
#include "server/loop/event_loop.h"
#include "server/loop/handshake_probe.h"
#include "storage/sqlite/store.h"
#include "tests/component/uplinkd/uplinkd_fixture.h"
#include "tests/support/eventually.h"
#include "tests/support/kept_lines.h"

namespace uplink::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ServingTest : public UplinkdTest {
 protected:
  using seconds = std::chrono::seconds;
};

TEST_F(ServingTest, AnswersProbesAndStopsCleanly) {
  Serve();
  EXPECT_EQ(HttpGet(http_, "/livez").status, 200);
  EXPECT_THAT(HttpGet(http_, "/readyz").body, HasSubstr(R"({"degraded":[)"));
  EXPECT_EQ(HttpGet(http_, "/api/v1/robots").status, 200);
  EXPECT_EQ(HttpGet(http_, "/api/v1/faults?active=true").status, 200);
  EXPECT_EQ(HttpGet(http_, "/api/v1/status").status, 200);
  for (const char* list : {"missions?open=true", "shapes", "objects?includeExpired=true"}) {
    EXPECT_EQ(HttpGet(http_, std::string("/api/v1/") + list).status, 200) << list;
  }
  process_->Signal(SIGTERM);
  EXPECT_EQ(process_->WaitForExit(), 0);
  EXPECT_THAT(process_->text(), HasSubstr("draining"));
  EXPECT_THAT(process_->text(), HasSubstr("stopped"));
}

/// The socket at which a service manager hears its services.
class ManagerSocket final {
 public:
  explicit ManagerSocket(const std::string& path)
      : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    UPLINK_CHECK(path.size() < sizeof(address.sun_path), path);
    path.copy(address.sun_path, path.size());
    const timeval patience{.tv_sec = kPatience.count() / 1000, .tv_usec = 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    const auto* bound = reinterpret_cast<const sockaddr*>(&address);
    UPLINK_CHECK(::bind(socket_, bound, sizeof(address)) == 0, path);
  }
  ~ManagerSocket() { ::close(socket_); }
  ManagerSocket(const ManagerSocket&) = delete;
  ManagerSocket& operator=(const ManagerSocket&) = delete;

  /// What a service said next; empty if nothing came in time.
  [[nodiscard]] std::string Next() const {
    std::array<char, 256> said{};
    const ssize_t size = ::recv(socket_, said.data(), said.size(), 0);
    return size < 0 ? std::string() : std::string(said.data(), static_cast<std::size_t>(size));
  }

 private:
  const int socket_;
};

TEST_F(ServingTest, TellsTheServiceManagerThatItIsReadyAndWellAndThatItStops) {
  const ManagerSocket manager(folder_.Path("notify"));
  Serve({"NOTIFY_SOCKET=" + folder_.Path("notify")});
  EXPECT_EQ(manager.Next(), "READY=1");
  EXPECT_EQ(manager.Next(), "WATCHDOG=1");
  EXPECT_EQ(manager.Next(), "WATCHDOG=1");
  process_->Signal(SIGTERM);
  EXPECT_EQ(process_->WaitForExit(), 0);
  EXPECT_EQ(manager.Next(), "STOPPING=1");
}

TEST_F(ServingTest, SigintDrainsToo) {
  Serve();
  process_->Signal(SIGINT);
  EXPECT_EQ(process_->WaitForExit(), 0);
}

TEST_F(ServingTest, ARealScrapePassesPrometheusChecker) {
  Serve();
  const RawAnswer scrape = HttpGet(http_, "/metrics");
  ASSERT_EQ(scrape.status, 200);
  EXPECT_THAT(scrape.body, HasSubstr("uplinkd_uplinks_received_total 0\n"));
  EXPECT_THAT(scrape.body, HasSubstr("uplinkd_streams_refused_total{cause=\"full\"} 0\n"));
  folder_.Write("scrape.txt", scrape.body);
  ServerProcess checker(
      {"/bin/sh", "-c", "exec promtool check metrics < \"$0\"", folder_.Path("scrape.txt")});
  EXPECT_EQ(checker.WaitForExit(), 0) << checker.text();
  EXPECT_EQ(checker.text(), "");
}

TEST_F(ServingTest, TheRelayAnswersTheBackgroundHandshake) {
  for (const char* version : {"1.2", "1.3"}) {
    Serve({std::string("UPLINKD_TLS_MIN_VERSION=") + version});
    const SystemClock clock;
    const log::Logger logger(std::make_unique<NoLines>(), clock, log::Format::kText,
                             log::Level::kError);
    loop::EventLoop loop(logger);
    std::promise<bool> answered;
    loop.Post([&] {
      loop::ProbeHandshake(loop, {.address = {"127.0.0.1", relay_}}, seconds(10),
                           [&](bool good) { answered.set_value(good); });
    });
    loop.Start();
    EXPECT_TRUE(answered.get_future().get()) << version;
    process_->Signal(SIGTERM);
    EXPECT_EQ(process_->WaitForExit(), 0);
  }
}

// It comes from an address from which a PROXY header is required.
TEST_F(ServingTest, TheBackgroundHandshakeSucceedsBehindALoadBalancerOfThisMachine) {
  Serve({"UPLINKD_LISTEN_PROXY_PROTOCOL_FROM=127.0.0.0/8,::1"});
  const auto age = [this] {
    constexpr std::string_view kKey = R"("relayLastHandshakeSeconds":)";
    const std::string body = HttpGet(http_, "/livez").body;
    const std::size_t at = body.find(kKey);
    return at == std::string::npos ? -1 : std::stod(body.substr(at + kKey.size()));
  };
  double oldest = 0;
  EXPECT_TRUE(Eventually([&] {
    const double now = age();
    const bool younger = now < oldest;
    oldest = std::max(oldest, now);
    return younger;
  })) << "the last handshake is "
      << oldest << " s old";
  EXPECT_THAT(HttpGet(http_, "/metrics").body,
              HasSubstr("uplinkd_connections_turned_away_total{cause=\"proxy_header\"} 0\n"));
}

TEST_F(ServingTest, TheProgramHoldsNoGrpcLibrary) {
  Serve();
  std::ifstream maps("/proc/" + std::to_string(process_->pid()) + "/maps");
  std::ostringstream libraries;
  libraries << maps.rdbuf();
  EXPECT_THAT(libraries.str(), HasSubstr("/libnghttp2.so")) << "its own libraries are listed";
  EXPECT_THAT(libraries.str(), Not(HasSubstr("/libgrpc")));
  EXPECT_THAT(libraries.str(), Not(HasSubstr("/libgpr.so")));
}

TEST_F(ServingTest, EveryLineOfTheLogIsOneObjectOfJson) {
  process_ = folder_.Start({}, {"UPLINKD_LOG_FORMAT=json"});
  const std::string key = R"("relay":"127.0.0.1:)";
  ASSERT_TRUE(process_->WaitFor(key) &&
              process_->WaitFor("\n", seconds(10), process_->text().find(key)))
      << process_->text();
  const std::string port = process_->text().substr(process_->text().find(key) + key.size());
  // Not TLS: the server has something to say of it.
  static_cast<void>(HttpGet(static_cast<std::uint16_t>(std::stoul(port)), "/"));
  ASSERT_TRUE(process_->WaitFor(R"("why":"no_tls")")) << process_->text();
  process_->Signal(SIGTERM);
  EXPECT_EQ(process_->WaitForExit(), 0);
  std::istringstream lines(process_->text());
  for (std::string line; std::getline(lines, line);) {
    EXPECT_TRUE(line.starts_with(R"({"time":")") && line.ends_with('}')) << line;
  }
}

TEST_F(ServingTest, RobotsOfTheStoreAreKnownFromTheStart) {
  {
    storage::sqlite::StoreOptions options;
    options.process = {1};
    auto store = storage::sqlite::SqliteStore::Open(folder_.Path("uplinkd.db"), options);
    ASSERT_TRUE(store.ok()) << store.status();
    const storage::OpenRequest open{
        .robot = std::make_shared<const model::RobotId>(model::RobotId{"rcan://a/b", "north"}),
        .at = FromUnixMs(1'763'683'200'000)};
    ASSERT_TRUE((*store)->OpenStreams(std::span(&open, 1)).ok());
  }
  Serve();
  const RawAnswer answer = HttpGet(http_, "/api/v1/robots/rcan%3A%2F%2Fa%2Fb");
  EXPECT_EQ(answer.status, 200);
  EXPECT_THAT(answer.body, HasSubstr(R"("presence":"unknown")"));
  EXPECT_THAT(answer.body, HasSubstr(R"("fleet":"north")"));
}

TEST_F(ServingTest, SighupTakesTheLogLevelAndNamesWhatNeedsARestart) {
  Serve();
  folder_.WriteConfig("[log]\nlevel = \"error\"\n[presence]\ntimeout = \"11s\"\n");
  const std::size_t before = process_->text().size();
  process_->Signal(SIGHUP);
  ASSERT_TRUE(process_->WaitFor("needs_restart=presence.timeout", seconds(30), before))
      << process_->text();
  process_->Signal(SIGTERM);
  EXPECT_EQ(process_->WaitForExit(), 0);
  // Of level info, so left out now.
  EXPECT_EQ(process_->text().find(" stopped", before), std::string::npos) << process_->text();
}

TEST_F(ServingTest, SighupWithABadFileChangesNothing) {
  Serve();
  folder_.WriteConfig("[log]\nlevel = \"loud\"\n");
  process_->Signal(SIGHUP);
  EXPECT_TRUE(process_->WaitFor("reload_refused")) << process_->text();
  EXPECT_EQ(HttpGet(http_, "/readyz").status, 200);
}

TEST_F(ServingTest, AStoreThatAnotherProcessHoldsStopsTheStart) {
  Serve();
  const auto second = folder_.Start();
  EXPECT_EQ(second->WaitForExit(), 1);
  EXPECT_THAT(second->text(), HasSubstr(folder_.Path("uplinkd.db")));
}

TEST_F(ServingTest, AStoreThatAnotherProcessHoldsByAnotherNameStopsTheStart) {
  Serve();
  std::filesystem::create_symlink(folder_.Path("uplinkd.db"), folder_.Path("link.db"));
  std::filesystem::create_hard_link(folder_.Path("uplinkd.db"), folder_.Path("hard.db"));
  for (const char* name : {"link.db", "hard.db"}) {
    const auto second = folder_.Start({}, {"UPLINKD_STORE_URL=sqlite://" + folder_.Path(name)});
    EXPECT_EQ(second->WaitForExit(), 1) << name;
    EXPECT_THAT(second->text(), HasSubstr(folder_.Path(name) + " is in use")) << name;
  }
}

TEST_F(ServingTest, APortThatIsTakenStopsTheStart) {
  Serve();
  for (const auto& [name, port] : {std::pair{"HTTP", http_}, std::pair{"RELAY", relay_}}) {
    const UplinkdFolder other;
    const std::string address = "127.0.0.1:" + std::to_string(port);
    const auto second = other.Start({}, {std::string("UPLINKD_LISTEN_") + name + "=" + address});
    EXPECT_EQ(second->WaitForExit(), 1) << name;
    EXPECT_THAT(second->text(), HasSubstr(address)) << name;
  }
}

}  // namespace
}  // namespace uplink::testing
