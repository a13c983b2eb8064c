#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/types.h"

namespace uplink::storage {

/// Rows of each history that one call of RemoveHistories deletes, about.
inline constexpr std::size_t kRemovedPerCallMax = 10'000;
/// Robots that one answer of SilentSince names; fewer: there are no more.
inline constexpr std::size_t kSilentRobotsMax = 100;
/// Requests that one answer of Pending names: the latest.
inline constexpr std::size_t kForgetRequestsMax = 100;
/// A request without an answer is asked for no longer than this, so that nothing happens long after
/// whoever asked has left.
inline constexpr std::chrono::minutes kForgetRequestLives{1};
/// So long servers are told that a robot is gone; one that was cut off for longer finds it missing.
inline constexpr std::chrono::hours kForgottenTold{24};

/// Who holds a robot, as its row says.
struct RobotHold {
  ProcessId owner{};
  /// Of its last stream, or adoption.
  Epoch epoch = 0;

  friend bool operator==(const RobotHold&, const RobotHold&) = default;
};

/// Rows that a table has of a robot.
struct TableCount {
  std::string_view table;
  std::uint64_t rows = 0;

  friend bool operator==(const TableCount&, const TableCount&) = default;
};

/// A robot of which nothing was heard for long.
struct SilentRobot {
  std::string ruri;
  Epoch epoch = 0;
};

/// What the holder says to a request.
enum class ForgetAnswer : std::uint8_t {
  kNone = 0,
  /// The robot is in its memory no more.
  kLetGo = 1,
  /// The robot has a stream, and that was not to be ended.
  kHasStream = 2,
  /// Records of it wait for the store.
  kRecordsWait = 3,
};

struct AnsweredForget {
  ForgetAnswer answer = ForgetAnswer::kNone;
  /// Of kLetGo: the epoch that the robot had when it was let go.
  Epoch epoch = 0;
};

/// A request as servers see it.
struct PendingForget {
  std::uint64_t number = 0;
  std::string ruri;
  bool end_stream = false;
  /// The robot's rows are gone, or whoever asked gave up: nobody waits for an answer.
  bool finished = false;
  /// Of its row now; nothing if there is none.
  std::optional<RobotHold> hold;
};

/// Takes robots out of a store for good, and passes on what an operator and the servers that share
/// the store have to say to each other about it, over a connection of its own.
///
/// Errors: as in Store: a status means that nothing of the call is known. Calling again is right.
/// Thread: confined to one thread at a time.
class RobotRemoval {
 public:
  virtual ~RobotRemoval() = default;

  // --- What there is ---

  /// Nothing if the store has no row of the robot.
  [[nodiscard]] virtual absl::StatusOr<std::optional<RobotHold>> HoldOf(std::string_view ruri) = 0;
  /// The tables that have rows of the robot, of kKeptTables in their order.
  [[nodiscard]] virtual absl::StatusOr<std::vector<TableCount>> Count(std::string_view ruri) = 0;
  /// Robots of which nothing was heard since `until`, and that no process but `self` can have a
  /// stream of: their holder is `self`, or is over. By RURI, those after `after`; at most
  /// kSilentRobotsMax.
  [[nodiscard]] virtual absl::StatusOr<std::vector<SilentRobot>> SilentSince(
      SystemTime until, const ProcessId& self, std::string_view after) = 0;

  // --- Removing ---

  /// Deletes what the robot is and has now (kRobotTables), in one transaction, if its epoch is that
  /// (0: if it has no row). False: it spoke meanwhile, and nothing was deleted.
  [[nodiscard]] virtual absl::StatusOr<bool> Remove(std::string_view ruri, Epoch epoch) = 0;
  /// Deletes of its histories what was written before the last Remove of this object, some at a
  /// call. Returns how many rows; 0 when none is left.
  [[nodiscard]] virtual absl::StatusOr<std::size_t> RemoveHistories(std::string_view ruri) = 0;

  // --- Whoever asks for it ---

  /// Asks the holder to let go of the robot. Returns the request's number.
  [[nodiscard]] virtual absl::StatusOr<std::uint64_t> Ask(std::string_view ruri,
                                                          bool end_stream) = 0;
  [[nodiscard]] virtual absl::StatusOr<AnsweredForget> AnswerTo(std::uint64_t number) = 0;
  /// The robot's rows are gone, or nobody waits for an answer any more.
  [[nodiscard]] virtual absl::Status Finish(std::uint64_t number) = 0;

  // --- Servers ---

  /// Unanswered requests, and those that are finished.
  [[nodiscard]] virtual absl::StatusOr<std::vector<PendingForget>> Pending() = 0;
  /// Nothing happens if somebody answered before.
  [[nodiscard]] virtual absl::Status Answer(std::uint64_t number, const AnsweredForget& answer) = 0;
};

}  // namespace uplink::storage
