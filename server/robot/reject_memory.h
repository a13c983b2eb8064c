#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "schema/model/ids.h"
#include "server/robot/rejected_seq.h"

namespace uplink::robot {

/// Rejected numbers in (after, through] that must be read. A value.
struct UnreadRejects {
  model::Seq after = 0;
  model::Seq through = 0;
};

/// The Rejects of one session: those that the next Welcome repeats, and those of the store that the
/// stream has not sent yet. It makes no decision. The store holds more: a stream learns them by
/// pages, or late if a Welcome goes out before the store has answered. Until it knows the last, no
/// Ack may cover the first that it may lack. Confined to its owner's lock.
///
/// Bounds: kRejectsRememberedMax are remembered, and as many limited ones; the lowest numbers go
///         first. Untold are at most as many as messages of the robot wait for commits
///         (in_flight_uplinks_max), and a page.
class RejectMemory final {
 public:
  /// Remembers a Reject for the next Welcome. A remembered number stays as it is.
  void Remember(RejectedSeq rejected);
  /// The same for a limited live message: the store never has it, and it needs no confirmation.
  void RememberLive(RejectedSeq limited);
  /// The store refused it: the stream must be told, and the next Welcome repeats it.
  void AddUntold(RejectedSeq rejected);
  /// How many Rejects the agent has not confirmed: those that the last RepeatForWelcome repeated,
  /// and later ones.
  [[nodiscard]] std::size_t unconfirmed() const { return unconfirmed_; }
  /// Rejects that the stream was not told yet, in the order of the commits.
  [[nodiscard]] std::vector<RejectedSeq> TakeUntold() { return std::exchange(untold_, {}); }
  /// The Rejects that a Welcome repeats: all known ones above `settled_seq`, ascending, each number
  /// once. Those of `stored`, from the store, are remembered too. Afterwards none is untold.
  [[nodiscard]] std::vector<RejectedSeq> RepeatForWelcome(model::Seq settled_seq,
                                                          std::vector<RejectedSeq> stored);
  /// The last RepeatForWelcome had the store's answer: memory has known all since.
  void SetComplete() { complete_ = true; }
  /// After a RepeatForWelcome without the store's answer. True if the stream may lack a Reject
  /// above `settled_seq`: memory dropped some, or is new while the agent knows of judged messages
  /// up to `judged_seq`. Also true if memory calls numbers up to `committed` settled, and the store
  /// may have lost them since. Then told_through holds until AddLate.
  bool AwaitLate(model::Seq settled_seq, model::Seq judged_seq, model::Seq committed = 0);
  /// The store's answer came after the Welcome: what memory lacks is untold. No effect unless it is
  /// awaited.
  void AddLate(std::vector<RejectedSeq> stored);
  /// The store's answer covers numbers up to `unread.after`, which are told or untold. Up to its
  /// cursor, `unread.through`, `more` must be read. Those above the cursor that memory dropped must
  /// be read too, once they are committed.
  void BeginPages(UnreadRejects unread, std::size_t more);
  /// The range to read next, if everything up to `committed` is committed; empty if there is none.
  [[nodiscard]] std::optional<UnreadRejects> unread(model::Seq committed) const;
  /// Something must be read, now or later.
  [[nodiscard]] bool has_unread() const { return told_through_ && pages_through_ > 0; }
  /// A page up to `through` was read: what memory lacks is untold.
  void AddPage(std::vector<RejectedSeq> page, model::Seq through);
  /// The number above which the stream may lack a Reject; empty if it knows all that are known.
  [[nodiscard]] const std::optional<model::Seq>& told_through() const { return told_through_; }
  /// The highest number that an Ack may call judged; empty: no limit. An agent that hears more
  /// would forget messages whose Rejects are still in pages. It may hear `known_judged` again,
  /// which it knows.
  [[nodiscard]] std::optional<model::Seq> judged_through(model::Seq known_judged) const;

 private:
  void AddUnlessRemembered(std::vector<RejectedSeq> stored);

  /// Ascending.
  std::deque<RejectedSeq> remembered_;
  /// Limited live messages, ascending.
  std::deque<RejectedSeq> live_limited_;
  /// The highest number that was dropped, or that only the store has; 0: none.
  model::Seq left_through_ = 0;
  std::optional<model::Seq> told_through_;
  /// Every Reject of the session is known, except up to left_through_.
  bool complete_ = false;
  /// The last number in pages; 0: there are no pages.
  model::Seq pages_through_ = 0;
  /// The store's answer counted them up to here.
  model::Seq counted_through_ = 0;
  /// The settled_seq of the last RepeatForWelcome.
  model::Seq settled_ = 0;
  std::vector<RejectedSeq> untold_;
  std::size_t unconfirmed_ = 0;
};

}  // namespace uplink::robot
