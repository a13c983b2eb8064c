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

/// Open mission runs of which the progress is kept; the least recently reported goes first.
inline constexpr std::size_t kOpenRunsMax = 16;

/// progress_x100 of one percent.
inline constexpr double kProgressAPercent = 100;
/// A computer that was up for longer than a century has no clock.
inline constexpr std::uint64_t kUptimeSMax = std::uint64_t{100} * 366 * 24 * 3600;

/// Runs that ended before it was read from the store what was open, and are remembered until then.
inline constexpr std::size_t kEndedRunsMax = 64;

/// How a run is named among a robot's open runs.
[[nodiscard]] inline std::string RunKey(std::string_view mission_id, std::string_view run_id) {
  return std::string(mission_id).append("/").append(run_id);
}

/// What a robot's durable reports say of it now, for its series. A value.
struct Reported {
  /// Progress in percent of open runs, by mission and run; the last one reported last. Nothing
  /// where a report named none.
  LatestByKey<std::optional<double>, kOpenRunsMax> open_runs;
  /// By the server's clock.
  std::optional<SystemTime> booted_at;
};

/// Follows the durable reports of a robot that its series look at. Confined to its owner's lock.
class Reports final {
 public:
  /// Whether such a report changes anything here. Pure: it needs no lock.
  [[nodiscard]] static bool Follows(const model::Body& report);
  void Add(const model::Body& report, SystemTime received_at);
  /// What the store knew; what was reported or ended meanwhile is newer.
  void Restore(Reported before);

  [[nodiscard]] const Reported& reported() const { return reported_; }

 private:
  Reported reported_;
  LatestByKey<bool, kEndedRunsMax> ended_runs_;
};

}  // namespace uplink::robot
