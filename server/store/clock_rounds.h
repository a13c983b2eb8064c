#pragma once

#include <chrono>
#include <functional>
#include <optional>

#include "schema/base/clock.h"
#include "server/log/logger.h"
#include "server/loop/one_at_a_time.h"
#include "server/store/clock_judge.h"
#include "server/store/marked_clock.h"
#include "server/store/vouched_clock.h"
#include "storage/clock_marks.h"

namespace uplink::store {

/// How often the mark is set.
inline constexpr std::chrono::minutes kMarkEvery{1};

/// Judges the civil clock repeatedly, keeps the store's mark, and logs when the clock is no longer
/// vouched for and when it is again.
///
/// While the store does not answer, its last answer counts. Before its first answer, nothing is
/// vouched for.
///
/// Thread: Round by one at a time, one that may wait for the store; LookOn by one.
class ClockRounds final {
 public:
  /// The references outlive it.
  struct Context {
    /// Judges its machine's clock, and tells it the mark.
    MarkedClock& clock;
    storage::ClockMarks& marks;
    VouchedClock& trust;
    const log::Logger& logger;
    std::function<bool()> kernel_synchronised;
  };
  explicit ClockRounds(Context context);
  ClockRounds(const ClockRounds&) = delete;
  ClockRounds& operator=(const ClockRounds&) = delete;

  /// The first round comes before anything is written, and sets the mark of a store without rows.
  void Round();
  /// Posts a Round to a thread that may wait, unless one is under way.
  void LookOn(const loop::Post& post) {
    looks_.PostBy(post, [this] { Round(); });
  }

 private:
  void Read();
  [[nodiscard]] ClockFacts FactsAt(const ClockPair& now) const;
  /// Tells MarkedClock the mark, so that it stamps no row well before it; or to forget the mark if
  /// the kernel or the database confirms the clock.
  void TellMark(Voucher voucher, const ClockFacts& facts);
  /// Notes whether civil time ran ahead since it was vouched for.
  void NoteJump(const ClockPair& now);
  void MoveMark(const ClockFacts& facts, const ClockPair& now);
  void Tell(Voucher voucher, const ClockFacts& facts);

  const Context context_;
  loop::OneAtATime looks_;
  /// The store's last answer, and its time.
  std::optional<storage::ClockReading> reading_;
  SteadyTime read_at_;
  std::optional<SystemTime> told_mark_;
  /// When the mark or the kernel last vouched for the clock, and when it was then seen ahead.
  std::optional<ClockPair> vouched_at_;
  std::optional<SteadyTime> jumped_at_;
  /// From when civil and monotonic time are compared for the next mark.
  ClockPair mark_from_;
  /// What the log was told last.
  std::optional<Voucher> told_;
};

}  // namespace uplink::store
