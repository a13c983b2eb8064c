#pragma once

#include <cstddef>
#include <deque>
#include <utility>
#include <vector>

#include "schema/model/ids.h"
#include "server/robot/rejected_seq.h"

namespace uplink::robot {

/// The Rejects of one session: those that the next Welcome repeats, and the store's that the stream
/// was not told yet. It decides none. Confined to its owner's lock.
///
/// Bounds: kRejectsRememberedMax are remembered, and as many that were limited; the lowest numbers
///         go first. Untold are at most as
///         many as messages of the robot wait for commits (in_flight_uplinks_max).
class RejectMemory final {
 public:
  /// For the next Welcome. A number that is remembered already stays as it is. One that was limited
  /// (kRateLimited) is in no quarantine, and need not be confirmed.
  void Remember(RejectedSeq rejected);
  /// The store refused it: the stream is to be told, and the next Welcome too.
  void AddUntold(RejectedSeq rejected);
  /// How many Rejects the agent has not said to have processed: those that the last TellAgain
  /// repeated, and those that came since.
  [[nodiscard]] std::size_t unconfirmed() const { return unconfirmed_; }
  /// What the stream was not told yet, in order of the commits.
  [[nodiscard]] std::vector<RejectedSeq> TakeUntold() { return std::exchange(untold_, {}); }
  /// What a Welcome repeats: all that is known above `settled_seq`, ascending, each number once.
  /// `stored` is what the store knows besides; it is remembered. Nothing is untold afterwards.
  [[nodiscard]] std::vector<RejectedSeq> TellAgain(model::Seq settled_seq,
                                                   std::vector<RejectedSeq> stored);

 private:
  void RememberLimited(RejectedSeq limited);

  /// Ascending.
  std::deque<RejectedSeq> remembered_;
  /// Ascending.
  std::deque<RejectedSeq> limited_;
  /// The highest number that had to leave; 0: none.
  model::Seq left_through_ = 0;
  std::vector<RejectedSeq> untold_;
  std::size_t unconfirmed_ = 0;
};

}  // namespace uplink::robot
