#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "schema/base/clock.h"
#include "schema/model/record.h"
#include "server/robot/latest_by_key.h"

namespace uplink::robot {

/// Open mission runs whose progress is kept; the least recently reported is evicted first.
inline constexpr std::size_t kOpenRunsMax = 16;

/// progress_x100 of one percent.
inline constexpr double kProgressAPercent = 100;
/// An uptime of more than a century means that the computer has no clock.
inline constexpr std::uint64_t kUptimeSMax = std::uint64_t{100} * 366 * 24 * 3600;

/// Runs that ended before the open ones were read from the store, and are remembered until then.
inline constexpr std::size_t kEndedRunsMax = 64;

/// The name of a run among a robot's open runs.
[[nodiscard]] inline std::string RunKey(std::string_view mission_id, std::string_view run_id) {
  return std::string(mission_id).append("/").append(run_id);
}

/// The state of a robot by its durable reports, for its series. A value.
struct Reported {
  /// Progress in percent of open runs, by mission and run, the last reported last; empty if a
  /// report had none.
  LatestByKey<std::optional<double>, kOpenRunsMax> open_runs;
  /// By the server's clock.
  std::optional<SystemTime> booted_at;
  /// When the last mission run that failed was reported, by the server's clock; since its start.
  std::optional<SystemTime> mission_failed_at;
  /// As its AgentInfo says; empty: it does not.
  std::string agent_version;
  std::string software_version;
};

/// Follows the durable reports that a robot's series need. Confined to its owner's lock.
class Reports final {
 public:
  /// Whether such a report changes anything here. Pure: it needs no lock.
  [[nodiscard]] static bool Follows(const model::Body& report);
  void Add(const model::Body& report, SystemTime received_at);
  /// Takes over what the store knew, unless it was reported or ended meanwhile.
  void Restore(Reported before);

  [[nodiscard]] const Reported& reported() const { return reported_; }

 private:
  Reported reported_;
  LatestByKey<bool, kEndedRunsMax> ended_runs_;
};

}  // namespace uplink::robot
