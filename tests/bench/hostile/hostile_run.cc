#include "tests/bench/hostile/hostile_run.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>

#include "schema/base/check.h"
#include "tests/bench/fair/others.h"
#include "tests/bench/fair/scrape.h"
#include "tests/bench/hostile/new_robot.h"
#include "tests/bench/hostile/traces.h"
#include "tests/bench/hostile/victim.h"
#include "tests/bench/pinned_server.h"
#include "tests/support/sqlite_shell.h"
#include "tools/uplink-fleet/run/http_client.h"

namespace uplink::bench {
namespace {

constexpr milliseconds kConnectWait{20'000};
constexpr milliseconds kWarmUp{1'000};
/// The attack is at its height.
constexpr milliseconds kNewRobotAfter{2'000};
constexpr milliseconds kReadLogEvery{200};
constexpr double kMiB = 1024.0 * 1024.0;
/// The robot whose waits are measured comes first.
constexpr int kNice = 19;
constexpr const char* kVictimRuri = "rcan://bench.local/robots/victim";

/// The store of one attack.
class FreshFile final {
 public:
  explicit FreshFile(std::string path) : path_(std::move(path)) { Remove(); }
  ~FreshFile() { Remove(); }
  FreshFile(const FreshFile&) = delete;
  FreshFile& operator=(const FreshFile&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  void Remove() const {
    std::error_code ignored;
    for (const char* end : {"", "-wal", "-shm"}) std::filesystem::remove(path_ + end, ignored);
  }
  const std::string path_;
};

testing::KeyPair Issued(const World& world, const std::string& ruri) {
  return world.folder.authority().Issue(testing::RobotSpec(ruri));
}

std::vector<link::Identity> VictimsOf(const World& world, int robots) {
  std::vector<link::Identity> victims;
  for (int i = 0; i < robots; ++i) {
    const std::string ruri = i == 0 ? kVictimRuri : fmt::format("{}{}", kVictimRuri, i + 1);
    const testing::KeyPair pair = Issued(world, ruri);
    auto identity = link::Identity::Parse(pair.certificate, pair.key);
    UPLINK_CHECK(identity.ok(), identity.status().ToString());
    victims.push_back(*std::move(identity));
  }
  return victims;
}

/// Messages of the victim up to that number that the store does not have.
std::uint64_t Missing(const std::string& store, const std::string& session, std::uint64_t acked) {
  std::string hex;
  for (const char byte : session) hex += fmt::format("{:02x}", static_cast<unsigned char>(byte));
  const std::string rows = testing::SqliteShell(store).Read(
      fmt::format("SELECT count(DISTINCT seq) FROM events WHERE ruri = '{}' AND session = x'{}' AND"
                  " seq BETWEEN 1 AND {}",
                  kVictimRuri, hex, acked));
  return acked - std::min<std::uint64_t>(acked, std::stoull(rows));
}

/// A new robot on its way in.
using Arrival = std::future<std::optional<milliseconds>>;

class Measurement final {
 public:
  Measurement(const HostileRun& run, const Attack& attack, PinnedServer& server)
      : run_(run),
        attack_(attack),
        server_(server),
        http_(fmt::format("127.0.0.1:{}", server.ports().http)),
        victim_(loop_, clock_, LinkTo(run.world, server), VictimsOf(run.world, run.robots)) {}

  /// What the server's store is asked for is left out.
  void Measure(HostileResult& result) {
    if (!victim_.Connect(kConnectWait)) {
      result.failure = "the victim was not welcomed";
      return;
    }
    static_cast<void>(For(kWarmUp));
    result.ack_ms_without = For(run_.window).ack_ms;
    if (server_.ended() || run_.stopped()) {
      result.failure = "the server ended, or the run was stopped, before the attack began";
      return;
    }
    const auto counted = Samples();
    result.memory_mib = MemoryMiB();
    Attacked(result);
    Recovers(result);
    result.growth_mib = std::max(0.0, memory_max_ - result.memory_mib);
    const auto counts = Samples();
    if (counted && counts) result.metric = GrownMost(*counted, *counts);
    result.acked = victim_.acked();
    if (run_.stopped()) result.failure = "stopped";
  }

  [[nodiscard]] const Victim& victim() const { return victim_; }

 private:
  static link::LinkOptions LinkTo(const World& world, const PinnedServer& server) {
    link::LinkOptions options;
    options.tls =
        *link::TlsClient::Create(world.folder.authority().certificate(), link::Alpn::kHttp2);
    options.address = *link::Resolve("127.0.0.1:" + std::to_string(server.ports().relay));
    return options;
  }

  double MemoryMiB() const { return static_cast<double>(server_.use().rss_bytes) / kMiB; }

  /// False where nothing that follows would mean anything.
  bool Turn() {
    memory_max_ = std::max(memory_max_, MemoryMiB());
    const SteadyTime now = clock_.Steady();
    if (now - log_read_ > kReadLogEvery) {
      server_.ReadLog();
      log_read_ = now;
    }
    return !run_.stopped() && !server_.ended();
  }

  OthersTally For(milliseconds time) {
    const SteadyTime end = clock_.Steady() + time;
    return victim_.Measure([&] { return Turn() && clock_.Steady() < end; });
  }

  Arrival Send(const std::string& name) {
    NewRobot robot{.port = server_.ports().relay,
                   .server_ca = run_.world.folder.authority().certificate(),
                   .identity = Issued(run_.world, "rcan://bench.local/robots/" + name)};
    return std::async(std::launch::async,
                      [this, robot = std::move(robot)] { return TimeToGetIn(robot, clock_); });
  }

  static bool IsOver(const auto& future) {
    return future.wait_for(milliseconds(0)) == std::future_status::ready;
  }

  void Attacked(HostileResult& result) {
    const SteadyTime began = clock_.Steady();
    const milliseconds lasts = std::max(run_.window, milliseconds(attack_.time_min));
    AttackSite site{.clock = clock_,
                    .port = server_.ports().relay,
                    .server_ca = run_.world.folder.authority().certificate(),
                    .identity = Issued(run_.world, std::string(kAttackerRuri)),
                    .until = began + lasts};
    const auto attacker = std::async(std::launch::async, [this, site = std::move(site)] {
      setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);
      attack_.run(site);
    });
    memory_max_ = 0;
    std::optional<Arrival> arrival;
    const SteadyTime height = began + std::min(kNewRobotAfter, lasts / 2);
    const OthersTally tally = victim_.Measure([&] {
      if (!arrival && clock_.Steady() >= height) arrival = Send("new");
      return Turn() && !(arrival && IsOver(attacker) && clock_.Steady() >= began + lasts);
    });
    result.ack_ms_with = tally.ack_ms;
    result.cut = tally.cut;
    result.unacked = tally.unacked;
    attacker.wait();
    if (arrival) result.new_robot_during = arrival->get();
  }

  void Recovers(HostileResult& result) {
    Arrival arrival = Send("newer");
    const OthersTally tally = victim_.Measure([&] { return Turn() && !IsOver(arrival); });
    result.new_robot_after = arrival.get();
    result.cut += tally.cut;
    // What had no Ack during the attack may have one by now.
    result.unacked = tally.unacked;
  }

  std::optional<std::map<std::string, double>> Samples() {
    const auto page = http_.Get("/metrics");
    if (page.ok()) return SamplesOf(*page);
    run_.say("  a request failed: " + page.status().ToString());
    return std::nullopt;
  }

  const HostileRun& run_;
  const Attack& attack_;
  PinnedServer& server_;
  const SystemClock clock_{};
  synthetic::HttpClient http_;
  link::Loop loop_;
  Victim victim_;
  double memory_max_ = 0;
  SteadyTime log_read_{};
};

}  // namespace

HostileResult RunAttack(const HostileRun& run, const Attack& attack) {
  run.say(fmt::format("{}: {}", attack.name, attack.about));
  HostileResult result{.attack = std::string(attack.name)};
  const FreshFile store(run.world.folder.Path("hostile.db"));
  auto server = PinnedServer::Start(run.world, {.program = run.server_bin,
                                                .store_url = "sqlite://" + store.path(),
                                                .descriptors_max = attack.descriptors_max});
  if (!server.ok()) {
    result.failure = std::string(server.status().message());
    return result;
  }
  std::string session;
  {
    Measurement measurement(run, attack, **server);
    measurement.Measure(result);
    session = measurement.victim().session();
  }
  result.server_ended = (*server)->ended();
  run.say("  the server: " + (*server)->Stop());
  const std::string_view line = LineThatNames((*server)->log());
  result.in_log = !line.empty();
  if (result.in_log) run.say("  its log: " + std::string(line));
  result.lost = Missing(store.path(), session, result.acked);
  return result;
}

}  // namespace uplink::bench
