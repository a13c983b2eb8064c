#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "schema/model/enum_text.h"
#include "schema/model/motion.h"

namespace uplink::model {

enum class MissionStatus : std::uint16_t {
  kUnknown = 0,
  kReady = 1,
  kStarting = 2,
  kRunning = 3,
  kPaused = 4,
  kBlocked = 5,
  kAborted = 6,
  kComplete = 7,
  kError = 8,
};
template <>
inline constexpr auto kEnumNames<MissionStatus> =
    std::to_array<std::string_view>({"unknown", "ready", "starting", "running", "paused", "blocked",
                                     "aborted", "complete", "error"});

/// True for a status after which a run makes no more progress. A report may follow all the same.
[[nodiscard]] constexpr bool IsTerminal(MissionStatus status) {
  return status == MissionStatus::kAborted || status == MissionStatus::kComplete ||
         status == MissionStatus::kError;
}

/// Progress or outcome of one run of a mission. Durable. A value.
struct MissionRunStatus {
  std::int64_t unix_time_ms = 0;
  /// Empty for a mission of the robot's own.
  std::string mission_id;
  std::string run_id;
  MissionStatus status = MissionStatus::kUnknown;
  std::optional<std::string> status_message;
  /// Percent times 100, 0 to 10,000.
  std::optional<std::uint16_t> progress_x100;
  std::optional<std::string> current_path_id;
  std::optional<Pose> current_target;
  std::optional<std::uint32_t> current_step;
  std::optional<std::uint32_t> total_steps;
  std::optional<std::int64_t> time_started_ms;
  std::optional<std::int64_t> expected_end_time_ms;
  std::optional<std::int64_t> time_completed_ms;
  std::optional<std::string> name;

  friend bool operator==(const MissionRunStatus&, const MissionRunStatus&) = default;
};

}  // namespace uplink::model
