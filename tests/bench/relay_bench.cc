#include "tests/bench/relay_bench.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "schema/base/check.h"
#include "schema/base/clock.h"
#include "schema/encode.h"
#include "tests/support/eventually.h"
#include "tests/support/raw_http.h"
#include "tools/uplink-fleet/report/process_use.h"

namespace uplink::bench {
namespace {

constexpr std::size_t kRobots = 16;
/// Messages that one robot has on its way.
constexpr std::size_t kAhead = 2048;
constexpr std::size_t kTextBytes = 120;
constexpr std::int64_t kTimeMs = 1'763'683'200'000;
constexpr std::chrono::seconds kWarmUp{1};
constexpr std::size_t kAcksARound = 400;
constexpr double kMicrosPerSecond = 1e6;

double MillisecondsSince(SteadyTime began, const Clock& clock) {
  return std::chrono::duration<double, std::milli>(clock.Steady() - began).count();
}

ClientStyle Messages() {
  model::Message message;
  message.unix_time_ms = kTimeMs;
  message.message = std::string(kTextBytes, 'm');
  return {.write = [text = schema::Encode(message)](std::uint64_t /*seq*/,
                                                    std::string& payload) { payload = text; },
          .durable = true};
}

ClientStyle Faults() {
  return {.write =
              [](std::uint64_t seq, std::string& payload) {
                model::Fault fault;
                fault.unix_time_ms = kTimeMs;
                fault.fault_id = "BENCH";
                fault.source = "bench";
                fault.active = seq % 2 == 0;
                payload = schema::Encode(fault);
              },
          .durable = true};
}

}  // namespace

RelayBench::RelayBench(std::vector<std::string> environment) {
  // What bare loops left behind is none of the server's work.
  environment.emplace_back("UPLINKD_STORE_RETENTION_HISTORY=0");
  // A few robots stand for a fleet: what one may have stored is not what is measured.
  environment.emplace_back("UPLINKD_LIMITS_DURABLE_RECORDS_RATE=0");
  environment.emplace_back("UPLINKD_LIMITS_DURABLE_BYTES_RATE=0");
  environment.emplace_back("UPLINKD_JOURNAL_ROBOT_SHARE=1");
  process_ = world_.folder.Start({}, environment);
  const auto ports = testing::WaitForPorts(*process_);
  UPLINK_CHECK(ports.has_value(), process_->text());
  ports_ = *ports;
}

Load::Where RelayBench::Where(const ClientStyle& style) {
  world_.MakeRobots(kRobots);
  return {.style = [style](std::size_t /*number*/) { return style; },
          .link = world_.LinkTo(ports_.relay),
          .identities = &world_.identities};
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
  Durable rows{{name, "rows/s", comparator, {}, {}}, {name + "_cpu", "us/row", "", {}, {}}};
  for (int round = 0; round < times.rounds; ++round) {
    {
      link::Loop loop;
      Load load(Where(Messages()), loop);
      load.ConnectUpTo(kRobots, kRobots);
      load.Flood(kAhead, frame_messages, kWarmUp);
      const SteadyTime began = clock.Steady();
      const double cpu_before = Cpu();
      const auto before = static_cast<double>(load.acked());
      load.Flood(kAhead, frame_messages, std::chrono::seconds(times.seconds));
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

std::vector<double> RelayBench::MeasureAcks(std::size_t count) {
  const SystemClock clock;
  link::Loop loop;
  Load load(Where(Faults()), loop);
  load.ConnectUpTo(1, 1);
  std::vector<double> took;
  took.reserve(count);
  for (std::size_t sent = 1; sent <= count; ++sent) {
    const SteadyTime began = clock.Steady();
    load.SendOneAndAwaitAck();
    took.push_back(MillisecondsSince(began, clock));
  }
  return took;
}

std::vector<Row> RelayBench::MeasureAckRows(const std::string& name, const std::string& comparator,
                                            const std::function<void()>& bare_commit,
                                            const Times& times) {
  const SystemClock clock;
  std::vector<Row> rows = {{name + "_p50", "ms", comparator, {}, {}},
                           {name + "_p99", "ms", comparator, {}, {}}};
  for (int round = 0; round < times.rounds; ++round) {
    const std::vector<double> ours = MeasureAcks(kAcksARound);
    std::vector<double> theirs;
    theirs.reserve(kAcksARound);
    for (std::size_t i = 0; i < kAcksARound; ++i) {
      const SteadyTime began = clock.Steady();
      bare_commit();
      theirs.push_back(MillisecondsSince(began, clock));
    }
    rows[0].value.Add(Quantile(ours, 0.5));
    rows[1].value.Add(Quantile(ours, 0.99));
    rows[0].comparator_value.Add(Quantile(theirs, 0.5));
    rows[1].comparator_value.Add(Quantile(theirs, 0.99));
  }
  return rows;
}

}  // namespace uplink::bench
