#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/bench/figures.h"
#include "tests/bench/load/load.h"
#include "tests/bench/world.h"

namespace uplink::bench {

/// How often and how long a figure is measured.
struct Times {
  int rounds = 5;
  int seconds = 2;
};

/// The real program on one store, with robots in front of it: from the robot's write to its Ack.
/// Nothing limits rates. Server, database and load share the machine.
///
/// Thread: confined to one thread.
class RelayBench final {
 public:
  /// Starts uplinkd with these settings in its environment (`UPLINKD_...=`).
  explicit RelayBench(std::vector<std::string> environment);

  /// Two rows: durable records per second, and the server's CPU for each. `comparator` runs a bare
  /// loop for so many seconds and returns its rows per second.
  struct Durable {
    Row rate;
    Row cpu;
  };
  [[nodiscard]] Durable MeasureDurable(const std::string& name, std::size_t frame_messages,
                                       const std::string& comparator,
                                       const std::function<double(int)>& bare, const Times& times);
  /// p50 and p99 of one robot's single faults on an idle server, beside a bare loop's commits of
  /// one record each.
  [[nodiscard]] std::vector<Row> MeasureAckRows(const std::string& name,
                                                const std::string& comparator,
                                                const std::function<void()>& bare_commit,
                                                const Times& times);

 private:
  /// Robots that say durable messages in this way.
  [[nodiscard]] Load::Where Where(const ClientStyle& style);
  void WaitUntilSettled();
  /// How long each of so many faults took from its write to its Ack, in milliseconds.
  [[nodiscard]] std::vector<double> MeasureAcks(std::size_t count);
  /// Seconds of CPU that the server used so far.
  [[nodiscard]] double Cpu() const;

  World world_;
  std::unique_ptr<testing::ServerProcess> process_;
  testing::Ports ports_;
};

}  // namespace uplink::bench
