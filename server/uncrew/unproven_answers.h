#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include "server/journal/journal.h"
#include "server/loop/wake.h"
#include "server/uncrew/waiting_samples.h"

namespace uplink::uncrew {

/// Answers of one drone that rest on what is remembered of the store, such as that a sample was
/// stored before. Memory is no proof: the store may be an older copy by now. Each waits for a
/// commit that begins later, which fails while the store is away; and if the store was connected to
/// anew, VoidAll comes first.
///
/// Limits: one request to the journal at a time, which covers all that came before it.
/// Thread: confined to its owner's lock but for Wake, which takes it. It ends while none is asked.
class UnprovenAnswers final : private loop::WakeInbox {
 public:
  UnprovenAnswers(journal::Journal& journal, std::mutex& owners)
      : journal_(journal), owners_(owners) {}

  /// Is committed with the proof of what is remembered now.
  [[nodiscard]] TicketRef Add();
  /// What is remembered counts no more. Returns whom to wake, without the lock.
  [[nodiscard]] std::vector<loop::StreamRef> VoidAll();
  /// The journal was asked, and has not answered.
  [[nodiscard]] bool asked() const { return asked_; }

 private:
  void Wake(std::uint64_t stream) override;
  void Ask();

  journal::Journal& journal_;
  std::mutex& owners_;
  bool asked_ = false;
  /// Of the answers that the request covers, and of those that came later; null: there are none.
  TicketRef covered_;
  TicketRef next_;
};

}  // namespace uplink::uncrew
