#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "tools/uplink-fleet/agent_model.h"
#include "tools/uplink-fleet/ledger.h"

namespace uplink::synthetic {

/// What every robot of a run does. Bounds are those of the flags.
struct ScenarioOptions {
  std::uint64_t seed = 1;
  /// Unique to the run: it is part of every fault's source and description.
  std::string run;
  /// Motion messages a second; a tick each.
  double rate_hz = 10;
  /// Share of motion messages in whose place something wrong is sent.
  double malformed_share = 0;
  /// Fault reports a second, on average.
  double faults_hz = 0.5;
};

/// One robot's seeded life: where it drives, what breaks, what it sends wrong. Each message is
/// entered into the ledger as it is made. The same seed and index give the same messages but for
/// times, run and marks.
///
/// Thread: confined to the robot's thread.
class RobotScript final {
 public:
  RobotScript(const ScenarioOptions& options, std::size_t index);

  /// The messages of one tick, at `now_ms` (Unix).
  [[nodiscard]] std::vector<Outgoing> Tick(std::int64_t now_ms, Ledger& ledger);
  [[nodiscard]] Outgoing Motion(std::int64_t now_ms, Ledger& ledger);
  [[nodiscard]] Outgoing Status(std::int64_t now_ms, Ledger& ledger);

 private:
  [[nodiscard]] Outgoing FaultMessage(std::int64_t now_ms, Ledger& ledger);
  [[nodiscard]] Outgoing Wrong(std::int64_t now_ms, Ledger& ledger);
  [[nodiscard]] model::Fault NewFault(std::int64_t now_ms, bool active, const std::string& id);
  [[nodiscard]] bool Chance(double probability);

  ScenarioOptions options_;
  std::size_t index_;
  std::mt19937_64 random_;
  std::uint64_t next_tag_ = 1;
  std::uint64_t ticks_ = 0;
  /// Position in 1/65536 degrees and charge in 1/16 percent: exact in every number format between
  /// here and the JSON that comes back.
  std::int32_t lat_ = 0;
  std::int32_t lon_ = 0;
  std::int32_t charge_ = 0;
};

}  // namespace uplink::synthetic
