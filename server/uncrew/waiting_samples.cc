#include "server/uncrew/waiting_samples.h"

#include <algorithm>
#include <ranges>
#include <utility>

#include "server/journal/entry.h"
#include "server/robot/mutation.h"

namespace uplink::uncrew {

TicketRef WaitingSamples::Add(const storage::SampleRef& mark,
                              std::vector<storage::CommitRecord>& records,
                              std::optional<model::RejectReason> rejected) {
  Waiting sample{.first = last_seq_ + 1,
                 .last = last_seq_ + records.size(),
                 .mark = mark,
                 .use = {.records = records.size(), .bytes = 0},
                 .rejected = rejected,
                 .ticket = std::make_shared<Ticket>()};
  for (storage::CommitRecord& record : records) {
    record.seq = ++last_seq_;
    record.sample = mark;
    sample.use.bytes += journal::CostOf(record);
  }
  use_ = use_ + sample.use;
  waiting_.push_back(std::move(sample));
  return waiting_.back().ticket;
}

TicketRef WaitingSamples::Find(std::uint32_t type, const storage::SampleDigest* digest) const {
  for (const Waiting& sample : waiting_ | std::views::reverse) {
    if (sample.mark->is_question || sample.mark->type != type) continue;
    if (digest == nullptr || sample.mark->digest == *digest) return sample.ticket;
    // Without a time, it is another one than the last.
    if (!sample.mark->timed) return nullptr;
  }
  return nullptr;
}

void WaitingSamples::Note(const robot::Settled& settled, Waiting& sample) {
  switch (settled.outcome.kind) {
    case storage::OutcomeKind::kStored:
      sample.stored = true;
      return;
    case storage::OutcomeKind::kDuplicate:
      sample.duplicate = true;
      return;
    case storage::OutcomeKind::kRefused:
      sample.ticket->refused = settled.outcome.rejection;
      return;
    case storage::OutcomeKind::kFenced:
      return;  // OnFenced tells of it
  }
}

void WaitingSamples::Finish(Waiting& sample, Settling& settling) {
  Ticket& ticket = *sample.ticket;
  ticket.state = Ticket::State::kCommitted;
  settling.use = settling.use + sample.use;
  std::ranges::copy(ticket.callers, std::back_inserter(settling.wake));
  // Who asked was counted.
  if (sample.mark->is_question) return;
  ticket.was_stored = sample.duplicate && !sample.stored;
  // The store keeps one record and refuses another, such as one fault too many: what it kept
  // counts.
  if (sample.stored) ticket.refused.reset();
  std::optional<model::RejectReason> reason = sample.rejected;
  if (!reason && ticket.refused) reason = ticket.refused->reason;
  --settling.counts.in_flight;
  if (ticket.was_stored) {
    ++settling.counts.duplicate;
  } else if (reason) {
    ++settling.counts.rejected;
    ++settling.counts.rejects[static_cast<std::size_t>(*reason)];
  } else {
    ++settling.counts.stored;
  }
}

WaitingSamples::Settling WaitingSamples::Settle(std::span<const robot::Settled> settled) {
  Settling settling;
  for (const robot::Settled& one : settled) {
    // What was void before is not here any more.
    if (waiting_.empty() || one.seq < waiting_.front().first) continue;
    Waiting& sample = waiting_.front();
    Note(one, sample);
    if (one.seq < sample.last) continue;
    Finish(sample, settling);
    waiting_.pop_front();
  }
  use_.records -= settling.use.records;
  use_.bytes -= settling.use.bytes;
  return settling;
}

WaitingSamples::Settling WaitingSamples::VoidAll() {
  Settling settling;
  for (Waiting& sample : waiting_) {
    sample.ticket->state = robot::Planted(robot::Mutation::kFencedSampleAnswered)
                               ? Ticket::State::kCommitted
                               : Ticket::State::kVoid;
    if (!sample.mark->is_question) {
      --settling.counts.in_flight;
      ++settling.counts.refused;
    }
    std::ranges::copy(sample.ticket->callers, std::back_inserter(settling.wake));
  }
  waiting_.clear();
  settling.use = std::exchange(use_, {});
  return settling;
}

}  // namespace uplink::uncrew
