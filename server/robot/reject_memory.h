#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "schema/model/ids.h"
#include "server/robot/rejected_seq.h"

namespace uplink::robot {

/// Rejected numbers in (after, through] that are to be read. A value.
struct UnreadRejects {
  model::Seq after = 0;
  model::Seq through = 0;
};

/// The Rejects of one session: those that the next Welcome repeats, and the store's that the stream
/// was not told yet. It decides none. The store holds more, which a stream is told by pages, or
/// late, where a Welcome goes out before the store has answered: until it is told the last, no Ack
/// may cover the first that it may lack. Confined to its owner's lock.
///
/// Bounds: kRejectsRememberedMax are remembered, and as many that were limited; the lowest numbers
///         go first. Untold are at most as many as messages of the robot wait for commits
///         (in_flight_uplinks_max), and a page.
class RejectMemory final {
 public:
  /// For the next Welcome. A number that is remembered already stays as it is.
  void Remember(RejectedSeq rejected);
  /// The same of a live message that was limited: the store never has it, and it need not be
  /// confirmed.
  void RememberLive(RejectedSeq limited);
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
  /// The TellAgain before had the store's answer: memory knows all since.
  void SetComplete() { complete_ = true; }
  /// After a TellAgain without the store's answer. True if the stream may not have been told a
  /// number above `settled_seq`: memory let go of some, or is new while the agent knows of messages
  /// up to `judged_seq` that were judged. Or if it may be told from memory that numbers up to
  /// `committed` are settled, which the store may not have any more. Then told_through holds until
  /// AddLate.
  bool AwaitLate(model::Seq settled_seq, model::Seq judged_seq, model::Seq committed = 0);
  /// The store's answer came after the Welcome: what memory does not have is untold. Does nothing
  /// unless it is awaited.
  void AddLate(std::vector<RejectedSeq> stored);
  /// The numbers of the store's answer were told, or are untold, up to `unread.after`; up to
  /// `unread.through`, the answer's cursor, `more` are to be read. Those above the cursor that
  /// memory let go of are to be read too, once they are committed.
  void BeginPages(UnreadRejects unread, std::size_t more);
  /// What is to be read next, where all up to `committed` is committed; nothing if nothing is.
  [[nodiscard]] std::optional<UnreadRejects> unread(model::Seq committed) const;
  /// Something is to be read, now or later.
  [[nodiscard]] bool has_unread() const { return told_through_ && pages_through_ > 0; }
  /// It was read up to `through`: what memory does not have is untold.
  void AddPage(std::vector<RejectedSeq> page, model::Seq through);
  /// The number above which the stream may not have been told a Reject; nothing while it was told
  /// all that are known.
  [[nodiscard]] const std::optional<model::Seq>& told_through() const { return told_through_; }
  /// The number above which no message may be called judged; nothing if any may. An agent that
  /// knows what was judged up to `known_judged` learns no more from being told that; what pages
  /// hold beyond it, it has yet to forget.
  [[nodiscard]] std::optional<model::Seq> judged_through(model::Seq known_judged) const;

 private:
  void AddUnlessRemembered(std::vector<RejectedSeq> stored);

  /// Ascending.
  std::deque<RejectedSeq> remembered_;
  /// Live ones that were limited, ascending.
  std::deque<RejectedSeq> live_limited_;
  /// The highest number that had to leave, or that is kept by the store alone; 0: none.
  model::Seq left_through_ = 0;
  std::optional<model::Seq> told_through_;
  /// Every Reject of the session is known, but for those up to left_through_.
  bool complete_ = false;
  /// The last number that pages hold; 0: there are none.
  model::Seq pages_through_ = 0;
  /// Up to here the store's answer counted them.
  model::Seq counted_through_ = 0;
  /// Of the last TellAgain.
  model::Seq settled_ = 0;
  std::vector<RejectedSeq> untold_;
  std::size_t unconfirmed_ = 0;
};

}  // namespace uplink::robot
