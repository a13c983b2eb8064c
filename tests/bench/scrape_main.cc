// What a scrape of a large fleet costs: written robot by robot, beside a library's registry with a
// gauge for each series.
#include <ctime>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <prometheus/gauge.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>
#include <unistd.h>

#include "schema/base/check.h"
#include "server/rcan/scrape.h"
#include "tests/bench/bench_flags.h"
#include "tests/support/kept_lines.h"
#include "tests/support/records.h"
#include "tools/uplink-fleet/report/process_use.h"

namespace uplink::bench {
namespace {

using metrics::Coding;
using metrics::Format;

struct Arguments : BenchFlags {
  Arguments() : BenchFlags{.rounds = 9} {}

  std::size_t series = 100'000;
};

constexpr std::size_t kJoints = 6;
constexpr double kKiB = 1024;

/// CPU of this process, which has one thread, for one call; in milliseconds, by the scheduler's own
/// count: getrusage counts ticks.
double CpuMs(const std::function<void()>& act) {
  const std::clock_t before = std::clock();
  act();
  return 1e3 * static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
}

/// A fleet of arms that said everything once.
class ArmFleet {
 public:
  explicit ArmFleet(std::size_t series) : fleet_(clock_, series, {}) {
    config_.series_max = 2 * series;
    for (std::size_t i = 0; Count() < series; ++i) Add(i);
  }

  rcan::RobotScrape& scrape() { return scrape_; }
  [[nodiscard]] std::size_t series() const {
    return static_cast<std::size_t>(probe_.series.value());
  }

 private:
  std::size_t Count() {
    // Counting is a scrape: every hundred robots is often enough.
    if (fleet_.size() % 100 == 0) UPLINK_CHECK(scrape_.Text(Format::kText, Coding::kPlain), "free");
    return series();
  }
  void Add(std::size_t index) {
    const std::string ruri = fmt::format("rcan://local.rcan/uplink/synthetic/1.0/arm-{:06}", index);
    robot::Robot& robot = **fleet_.FindOrAdmit({ruri, "default"});
    robot.state.SignOfLife(clock_.Steady(), clock_.System(), {});
    std::vector<model::Record> records;
    model::MotionTelemetry motion;
    motion.pose = model::Pose{47.123456, 8.654321, 410.5, 90.25};
    motion.velocity = model::VelTwist{1.5F, 0.25F};
    records.push_back(test::RecordOf(motion));
    model::StatusTelemetry status;
    status.battery =
        model::BatteryStatus{.soc_pct = 77.5F, .voltage_v = 25.1F, .temperature = 31.0F};
    status.range_remaining = 1234.5;
    records.push_back(test::RecordOf(status));
    robot.state.Apply(records, clock_.Steady());
    model::RcanState state;
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      state.joints.push_back({.joint = fmt::format("joint_{}", joint),
                              .position_rad = 0.785 + static_cast<double>(joint),
                              .velocity_rad_s = 0.0213,
                              .position_m = std::nullopt,
                              .velocity_m_s = std::nullopt,
                              .effort_nm = 0.41,
                              .temperature_c = 38.5,
                              .error_flags = 0,
                              .timestamp_us = 1});
    }
    robot.state.Apply(std::move(state), clock_.Steady());
  }

  SystemClock clock_;
  log::Logger logger_{std::make_unique<testing::NoLines>(), clock_, log::Format::kText,
                      log::Level::kError};
  fleet::Fleet fleet_;
  config::RcanConfig config_;
  view::FaultCounts faults_{clock_};
  rcan::RcanProbe probe_;
  rcan::RobotScrape scrape_{{clock_, fleet_, config_, faults_, probe_, logger_}};
};

/// The library's way: a gauge a series.
class GaugeRegistry {
 public:
  explicit GaugeRegistry(std::size_t series) {
    constexpr std::size_t kFamilies = 50;
    for (std::size_t family = 0; family < kFamilies; ++family) {
      auto& gauges = prometheus::BuildGauge()
                         .Name(fmt::format("rcan_acb_field_{}_rad", family))
                         .Help("Angle of the joint, radians.")
                         .Register(registry_);
      for (std::size_t robot = 0; robot < series / kFamilies; ++robot) {
        gauges
            .Add({{"joint", "joint_1"},
                  {"ruri", fmt::format("rcan://local.rcan/uplink/synthetic/1.0/arm-{:06}", robot)}})
            .Set(0.785 + static_cast<double>(robot));
      }
    }
  }
  std::size_t Write() {
    std::ostringstream out;
    prometheus::TextSerializer().Serialize(out, registry_.Collect());
    return std::move(out).str().size();
  }

 private:
  prometheus::Registry registry_;
};

std::uint64_t Resident() {
  const auto use = synthetic::UseOf(::getpid());
  UPLINK_CHECK(use.has_value(), "a process can look at itself");
  return use->rss_bytes;
}

/// Scrapes in each form, beside the library's, round by round.
class ScrapeBench {
 public:
  explicit ScrapeBench(std::size_t series) : fleet_(series), registry_(series) {}

  std::vector<Row> Run(int rounds) {
    Each();  // what is used again is there from now on
    Compare();
    for (Row* row : {&plain_, &open_metrics_, &zipped_}) row->value = row->comparator_value = {};
    const std::uint64_t before = Resident();
    for (int round = 0; round < rounds; ++round) {
      Each();
      Compare();
    }
    const std::uint64_t after = Resident();
    Row grew{"memory_grew_over_all_rounds", "KiB", "", {}, {}};
    grew.value.Add(after > before ? static_cast<double>(after - before) / kKiB : 0);
    return {plain_, open_metrics_, zipped_, grew};
  }
  [[nodiscard]] std::size_t series() const { return fleet_.series(); }

 private:
  void Each() {
    plain_.value.Add(Scrape(Format::kText, Coding::kPlain));
    open_metrics_.value.Add(Scrape(Format::kOpenMetrics, Coding::kPlain));
    zipped_.value.Add(Scrape(Format::kText, Coding::kGzip));
  }
  void Compare() {
    std::size_t bytes = 0;
    const double library = CpuMs([&] { bytes = registry_.Write(); });
    UPLINK_CHECK(bytes > 0, "it writes");
    for (Row* row : {&plain_, &open_metrics_, &zipped_}) row->comparator_value.Add(library);
  }
  double Scrape(Format format, Coding coding) {
    return CpuMs([&] { UPLINK_CHECK(fleet_.scrape().Text(format, coding), "a text is free"); });
  }

  ArmFleet fleet_;
  GaugeRegistry registry_;
  Row plain_{"scrape_100k_series", "ms CPU", "prometheus-cpp", {}, {}};
  Row open_metrics_{"scrape_100k_openmetrics", "ms CPU", "prometheus-cpp", {}, {}};
  Row zipped_{"scrape_100k_gzip", "ms CPU", "prometheus-cpp", {}, {}};
};

int Run(int argc, char** argv) {
  Arguments arguments;
  config::Flags flags("Benchmark of the robots' scrape", "uplink_bench_scrape");
  arguments.AddTo(flags);
  flags.Add({"--series"}, arguments.series, {1000, 1'000'000});
  if (const auto code = flags.Parse(argc, argv)) return *code;
  ScrapeBench bench(arguments.series);
  const std::vector<Row> rows = bench.Run(arguments.rounds);
  return Publish(
      arguments,
      fmt::format("scrape: {} series of ours, {} of the library's, on one core; {} rounds",
                  bench.series(), arguments.series, arguments.rounds),
      rows);
}

}  // namespace
}  // namespace uplink::bench

int main(int argc, char** argv) { return uplink::bench::Run(argc, argv); }
