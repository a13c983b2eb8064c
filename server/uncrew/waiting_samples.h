#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "metrics/ledger.h"
#include "schema/model/ids.h"
#include "schema/model/rejection.h"
#include "server/loop/wake.h"
#include "server/robot/calls.h"
#include "server/robot/commit_client.h"
#include "storage/commit_record.h"

namespace uplink::uncrew {

/// One sample that waits for its commit, with the calls that wait for it. Under the lock of its
/// drone.
struct Ticket {
  enum class State : std::uint8_t {
    kWaiting,
    kCommitted,
    /// The claim under which it was judged is over: the calls must offer it again.
    kVoid,
  };
  State state = State::kWaiting;
  /// Why the store did not keep it.
  std::optional<model::Rejection> refused{};
  /// The store had it before.
  bool was_stored = false;
  /// The calls to wake.
  std::vector<loop::StreamRef> callers{};
};
using TicketRef = std::shared_ptr<Ticket>;

/// The samples of one drone that wait for their commit, with numbers of the drone's own.
///
/// Limits: kCallsInFlightMax samples with a call, and the robot's share of the journal.
/// Thread: confined to its owner's lock.
class WaitingSamples final {
 public:
  /// Waiting records count in `calls`.
  explicit WaitingSamples(robot::Calls& calls) : calls_(calls) {}
  ~WaitingSamples() { calls_.EndWaiting(use_); }
  WaitingSamples(const WaitingSamples&) = delete;
  WaitingSamples& operator=(const WaitingSamples&) = delete;

  /// Numbers the records of a sample, which share this mark.
  [[nodiscard]] TicketRef Add(const storage::SampleRef& mark,
                              std::vector<storage::CommitRecord>& records,
                              std::optional<model::RejectReason> rejected);
  /// The last waiting sample of this type, and with this digest if one is given; null if there is
  /// none.
  [[nodiscard]] TicketRef Find(std::uint32_t type, const storage::SampleDigest* digest) const;

  /// The ticket of a question that goes to the store after this call, for an answer that rests on
  /// memory. At most one question of a drone is on its way; calls that ask meanwhile share the
  /// next.
  [[nodiscard]] TicketRef Ask();
  /// Whether calls wait for a question that can go now, by AddQuestion.
  [[nodiscard]] bool HasDueQuestion() const {
    return !question_on_its_way_ && question_ != nullptr && !question_->callers.empty();
  }
  /// Numbers the record of a question, which no count includes.
  void AddQuestion(std::vector<storage::CommitRecord>& question);

  /// The result of settling. A value.
  struct Settling {
    metrics::MessageCounts counts;
    std::vector<loop::StreamRef> wake;
  };
  [[nodiscard]] Settling Settle(std::span<const robot::Settled> settled);
  [[nodiscard]] Settling VoidAll();
  /// Memory is in doubt: calls that wait for a question must offer their samples again. Returns the
  /// calls to wake.
  [[nodiscard]] std::vector<loop::StreamRef> VoidQuestions();

  [[nodiscard]] bool empty() const { return waiting_.empty(); }

 private:
  struct Waiting {
    model::Seq first = 0;
    model::Seq last = 0;
    storage::SampleRef mark;
    robot::JournalUse use;
    std::optional<model::RejectReason> rejected;
    TicketRef ticket;
    bool stored = false;
    bool duplicate = false;
  };

  TicketRef Push(const storage::SampleRef& mark, std::vector<storage::CommitRecord>& records,
                 std::optional<model::RejectReason> rejected, TicketRef ticket);
  static void Note(const robot::Settled& settled, Waiting& sample);
  void Finish(Waiting& sample, Settling& settling);
  void VoidFront(Settling& settling);
  /// The records no longer wait.
  void EndUse(const robot::JournalUse& use);

  robot::Calls& calls_;
  model::Seq last_seq_ = 0;
  robot::JournalUse use_;
  /// In order of their numbers.
  std::deque<Waiting> waiting_;
  /// The ticket of the next question; null: no call asks.
  TicketRef question_;
  bool question_on_its_way_ = false;
};

}  // namespace uplink::uncrew
