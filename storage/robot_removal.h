#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/epoch.h"
#include "storage/identity.h"
#include "storage/origin.h"
#include "storage/robot_hold.h"

namespace uplink::storage {

/// Rows of each history that one call of RemoveHistories deletes, about.
inline constexpr std::size_t kRemovedPerCallMax = 10'000;
/// Robots that one answer of SilentSince names; fewer: there are no more.
inline constexpr std::size_t kSilentRobotsMax = 100;
/// Entries of histories below this number.
enum class EntryBound : std::int64_t {};

/// Rows that a table has of a robot.
struct TableCount {
  std::string_view table;
  std::uint64_t rows = 0;

  friend bool operator==(const TableCount&, const TableCount&) = default;
};

/// A robot that was silent for long.
struct SilentRobot {
  std::string ruri;
  Epoch epoch = 0;
};

/// Takes robots out of a store for good.
///
/// Errors: as in Store: a status means that nothing of the call is known. Calling again is right.
/// Thread: confined to one thread at a time, together with what shares its connection.
class RobotRemoval {
 public:
  virtual ~RobotRemoval() = default;

  // --- What there is ---

  /// Nothing if the store has no row of the robot.
  [[nodiscard]] virtual absl::StatusOr<std::optional<RobotHold>> HoldOf(std::string_view ruri) = 0;
  /// The tables that have rows of the robot, of kKeptTables in their order.
  [[nodiscard]] virtual absl::StatusOr<std::vector<TableCount>> Count(std::string_view ruri) = 0;
  /// Robots that were silent since `until` and whose holder is `self`, or is over, so that no other
  /// process can have a stream of theirs. By RURI, those after `after`; at most
  /// kSilentRobotsMax.
  [[nodiscard]] virtual absl::StatusOr<std::vector<SilentRobot>> SilentSince(
      SystemTime until, const ProcessId& self, std::string_view after) = 0;

  // --- Removing ---

  /// Deletes what the robot is and has now (kRobotTables), and its labels and note, in one
  /// transaction, if its epoch is that (0: if it has no row). Returns the bound of its histories: every entry of the robot that was
  /// removed is below it, and none of one that comes later. Nothing: it spoke meanwhile, and
  /// nothing was deleted.
  [[nodiscard]] virtual absl::StatusOr<std::optional<EntryBound>> Remove(std::string_view ruri,
                                                                         Epoch epoch) = 0;
  /// Deletes of the robot's histories what is below the bound that Remove returned, some at a call.
  /// Returns how many rows; 0 when none is left.
  [[nodiscard]] virtual absl::StatusOr<std::size_t> RemoveHistories(std::string_view ruri,
                                                                    EntryBound below) = 0;
};

}  // namespace uplink::storage
