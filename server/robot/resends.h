#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <optional>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "storage/latest_kind.h"

namespace uplink::robot {

/// A message of a robot, by its number.
struct SentMessage {
  model::SessionId session;
  model::Seq seq = 0;
};

/// The part of Resends that a stream looks at without the lock. A value.
struct ResendView {
  /// Kinds without a message in the store or on its way there.
  storage::LatestKindSet missing = 0;
  /// Those of them for which the robot was asked.
  storage::LatestKindSet unanswered = 0;
};

/// The kinds whose latest message of a robot the store lacks, and when the robot was asked for
/// each: at most once in kResendEvery, over all its streams.
///
/// Thread: confined to its owner's lock, except view(), which any thread may call.
class Resends final {
 public:
  /// A stream begins: what the store lacks is unknown until it answers.
  void Begin() { Set(0, asked_); }
  /// The store has messages of `held`, and has reported every earlier commit. `waits` says whether
  /// a message waits for its commit.
  void Answer(storage::LatestKindSet held, const std::function<bool(const SentMessage&)>& waits);
  /// A good message of the kind waits for its commit or has it: the request is answered.
  void AddGood(storage::LatestKind kind, const SentMessage& message);

  /// The kinds to ask the robot for now, which counts as done, and when to look again while any is
  /// missing.
  struct Due {
    storage::LatestKindSet kinds = 0;
    std::optional<SteadyTime> next;
  };
  [[nodiscard]] Due Take(SteadyTime now);
  /// Spares a stream the lock while nothing is missing.
  [[nodiscard]] ResendView view() const { return view_.load(); }

 private:
  void Set(storage::LatestKindSet missing, storage::LatestKindSet asked);

  storage::LatestKindSet missing_ = 0;
  /// Kinds that the robot was asked for and has not sent since.
  storage::LatestKindSet asked_ = 0;
  std::atomic<ResendView> view_{};
  std::array<std::optional<SteadyTime>, storage::kLatestKinds> asked_at_;
  std::array<std::optional<SentMessage>, storage::kLatestKinds> sent_;
};

}  // namespace uplink::robot
