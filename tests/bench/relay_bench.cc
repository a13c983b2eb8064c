#include "tests/bench/relay_bench.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <utility>

#include "schema/base/check.h"
#include "schema/base/clock.h"
#include "tests/support/eventually.h"
#include "tests/support/raw_http.h"
#include "tools/uplink-fleet/report/process_use.h"

namespace uplink::bench {
namespace {

constexpr std::size_t kRobots = 16;
/// Messages that one robot has on its way.
constexpr std::size_t kAhead = 2048;
constexpr int kWarmUpSeconds = 1;
constexpr std::size_t kAcksARound = 400;
constexpr double kMicrosPerSecond = 1e6;

void WaitFor(int seconds) {
  std::mutex mutex;
  std::condition_variable never;
  std::unique_lock lock(mutex);
  never.wait_for(lock, std::chrono::seconds(seconds), [] { return false; });
}

double Percentile(const std::vector<double>& sorted, double share) {
  const auto at = static_cast<std::size_t>(share * static_cast<double>(sorted.size()));
  return sorted[std::min(at, sorted.size() - 1)];
}

}  // namespace

RelayBench::RelayBench(std::vector<std::string> environment) {
  // What bare loops left behind is none of the server's work.
  environment.emplace_back("UPLINKD_STORE_RETENTION_HISTORY=0");
  // A few robots stand for a fleet: what one may have stored is not what is measured.
  environment.emplace_back("UPLINKD_LIMITS_DURABLE_RECORDS_RATE=0");
  environment.emplace_back("UPLINKD_LIMITS_DURABLE_BYTES_RATE=0");
  environment.emplace_back("UPLINKD_JOURNAL_ROBOT_SHARE=1");
  process_ = folder_.Start({}, environment);
  const auto ports = testing::WaitForPorts(*process_);
  UPLINK_CHECK(ports.has_value(), process_->text());
  ports_ = *ports;
}

RelayShape RelayBench::Shape(std::size_t robots) {
  RelayShape shape;
  shape.port = ports_.relay;
  shape.server_ca = folder_.authority().certificate();
  shape.ahead = kAhead;
  for (std::size_t robot = 0; robot < robots; ++robot) {
    shape.identities.push_back(
        folder_.authority().Issue(testing::RobotSpec("rcan://bench/" + std::to_string(robot))));
  }
  return shape;
}

void RelayBench::WaitUntilSettled() {
  const bool settled = testing::Eventually(
      [&] {
        const std::string body = testing::HttpGet(ports_.http, "/api/v1/status").body;
        return body.find(R"("inFlight":"0")") != std::string::npos;
      },
      std::chrono::minutes(1));
  UPLINK_CHECK(settled, "what the robots left is committed");
}

double RelayBench::Cpu() const {
  const auto use = synthetic::UseOf(process_->pid());
  UPLINK_CHECK(use.has_value(), "the server still runs");
  return use->cpu_seconds;
}

RelayBench::Durable RelayBench::MeasureDurable(const std::string& name, std::size_t frame_messages,
                                               const std::string& comparator,
                                               const std::function<double(int)>& bare,
                                               const Times& times) {
  const SystemClock clock;
  RelayShape shape = Shape(kRobots);
  shape.frame_messages = frame_messages;
  Durable rows{{name, "rows/s", comparator, {}, {}}, {name + "_cpu", "us/row", "", {}, {}}};
  for (int round = 0; round < times.rounds; ++round) {
    {
      const RelayLoad load(shape);
      WaitFor(kWarmUpSeconds);
      const SteadyTime began = clock.Steady();
      const double cpu_before = Cpu();
      const auto before = static_cast<double>(load.acked());
      WaitFor(times.seconds);
      const double acked = static_cast<double>(load.acked()) - before;
      const double cpu = Cpu() - cpu_before;
      rows.rate.value.Add(acked / std::chrono::duration<double>(clock.Steady() - began).count());
      rows.cpu.value.Add(cpu * kMicrosPerSecond / std::max(acked, 1.0));
    }
    WaitUntilSettled();
    rows.rate.comparator_value.Add(bare(times.seconds));
  }
  return rows;
}

std::vector<Row> RelayBench::MeasureAckRows(const std::string& name, const std::string& comparator,
                                            const std::function<void()>& bare_commit,
                                            const Times& times) {
  const SystemClock clock;
  const RelayShape shape = Shape(1);
  std::vector<Row> rows = {{name + "_p50", "ms", comparator, {}, {}},
                           {name + "_p99", "ms", comparator, {}, {}}};
  for (int round = 0; round < times.rounds; ++round) {
    const std::vector<double> ours = MeasureAcks(shape, kAcksARound);
    std::vector<double> theirs;
    theirs.reserve(kAcksARound);
    for (std::size_t i = 0; i < kAcksARound; ++i) {
      const SteadyTime began = clock.Steady();
      bare_commit();
      theirs.push_back(std::chrono::duration<double, std::milli>(clock.Steady() - began).count());
    }
    std::ranges::sort(theirs);
    rows[0].value.Add(Percentile(ours, 0.5));
    rows[1].value.Add(Percentile(ours, 0.99));
    rows[0].comparator_value.Add(Percentile(theirs, 0.5));
    rows[1].comparator_value.Add(Percentile(theirs, 0.99));
  }
  return rows;
}

}  // namespace uplink::bench
