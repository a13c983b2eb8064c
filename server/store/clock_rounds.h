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

/// Judges the civil clock again and again, keeps the store's mark, and tells the log when the clock
/// is no longer vouched for and when it is again.
///
/// While the store does not answer, the clock is judged by what it said last; nothing is vouched
/// for before it has answered once.
///
/// Thread: Round by one at a time, one that may wait for the store; LookOn by one.
class ClockRounds final {
 public:
  /// The references outlive it.
  struct Context {
    /// Its machine's clock is judged; it is told the mark.
    MarkedClock& clock;
    storage::ClockMarks& marks;
    VouchedClock& trust;
    const log::Logger& logger;
    std::function<bool()> kernel_synchronised;
  };
  explicit ClockRounds(Context context);
  ClockRounds(const ClockRounds&) = delete;
  ClockRounds& operator=(const ClockRounds&) = delete;

  /// The first one comes before anything is written: a store without rows gets its mark then.
  void Round();
  /// A Round by a job on a thread that may wait, unless one is under way.
  void LookOn(const loop::Post& post) {
    looks_.PostBy(post, [this] { Round(); });
  }

 private:
  void Read();
  [[nodiscard]] ClockFacts FactsAt(const ClockPair& now) const;
  /// What rows are stamped by does not stand well before the mark, unless the kernel knows better.
  void TellMark(Voucher voucher, const ClockFacts& facts);
  /// Notes whether civil time ran ahead since it was vouched for.
  void NoteJump(const ClockPair& now);
  void MoveMark(const ClockFacts& facts, const ClockPair& now);
  void Tell(Voucher voucher, const ClockFacts& facts);

  const Context context_;
  loop::OneAtATime looks_;
  /// What the store said last, and when.
  std::optional<storage::ClockReading> reading_;
  SteadyTime read_at_;
  std::optional<SystemTime> told_mark_;
  /// When the mark or the kernel vouched for the clock last, and when it was seen ahead of that.
  std::optional<ClockPair> vouched_at_;
  std::optional<SteadyTime> jumped_at_;
  /// Since when civil and monotonic time are compared for the next mark.
  ClockPair mark_from_;
  /// What the log was told last.
  std::optional<Voucher> told_;
};

}  // namespace uplink::store
