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

#include "storage/epoch.h"
#include "storage/robot_hold.h"

namespace uplink::storage {

/// Requests that one answer of Pending names: the latest.
inline constexpr std::size_t kForgetRequestsMax = 100;
/// A request without an answer lapses after this, so that nothing happens long after the program
/// that asked has left.
inline constexpr std::chrono::minutes kForgetRequestLives{1};
/// How long servers are told that a robot is gone; one that was cut off longer finds it missing.
inline constexpr std::chrono::hours kForgottenTold{24};

/// What the holder says to a request.
enum class ForgetAnswer : std::uint8_t {
  kNone = 0,
  /// The robot is in its memory no more.
  kLetGo = 1,
  /// The robot has a stream, and the request did not ask to end it.
  kHasStream = 2,
  /// Records of it wait for the store.
  kRecordsWait = 3,
};

/// What stands in a store in place of an answer once the robot's rows were removed.
inline constexpr int kForgetRemoved = 4;

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
  /// The robot's rows are gone, or the program that asked gave up: no answer is needed.
  bool finished = false;
  /// Of a finished one: the robot's rows were removed, though it may have a row again. False of
  /// those that an earlier build finished.
  bool removed = false;
  /// Of its row now; nothing if there is none.
  std::optional<RobotHold> hold;
};

/// What an operator who wants a robot to be forgotten, and the servers that share the store, have
/// to say to each other.
///
/// Errors: as in Store: a status means that nothing of the call is known. Calling again is right.
/// Thread: confined to one thread at a time, together with what shares its connection.
class ForgetRequests {
 public:
  virtual ~ForgetRequests() = default;

  // --- The program that asks ---

  /// Asks the holder to let go of the robot. Returns the request's number.
  [[nodiscard]] virtual absl::StatusOr<std::uint64_t> Ask(std::string_view ruri,
                                                          bool end_stream) = 0;
  [[nodiscard]] virtual absl::StatusOr<AnsweredForget> AnswerTo(std::uint64_t number) = 0;
  /// No answer is needed any more: the robot's rows were removed, or (`removed` is false) the
  /// program that asked gave up. Takes the place of the answer.
  [[nodiscard]] virtual absl::Status Finish(std::uint64_t number, bool removed) = 0;

  // --- Servers ---

  /// Unanswered requests that are not too old, and those that are finished: the latest first, at
  /// most kForgetRequestsMax.
  [[nodiscard]] virtual absl::StatusOr<std::vector<PendingForget>> Pending() = 0;
  /// Nothing happens if somebody answered before, or the request is finished.
  [[nodiscard]] virtual absl::Status Answer(std::uint64_t number, const AnsweredForget& answer) = 0;
};

}  // namespace uplink::storage
