#include "server/uncrew/waiting_samples.h"

#include <algorithm>
#include <utility>

#include "schema/base/check.h"
#include "server/journal/entry.h"
#include "server/robot/mutation.h"

namespace uplink::uncrew {

TicketRef WaitingSamples::Add(const storage::SampleRef& mark,
                              std::vector<storage::CommitRecord>& records,
                              std::optional<model::RejectReason> rejected) {
  return Push(mark, records, rejected, std::make_shared<Ticket>());
}

TicketRef WaitingSamples::Ask() {
  if (question_ == nullptr) question_ = std::make_shared<Ticket>();
  return question_;
}

void WaitingSamples::AddQuestion(std::vector<storage::CommitRecord>& question) {
  UPLINK_CHECK(HasDueQuestion(), "a second question of a drone is on its way");
  question_on_its_way_ = true;
  Push(question.front().sample, question, std::nullopt, std::exchange(question_, nullptr));
}

TicketRef WaitingSamples::Push(const storage::SampleRef& mark,
                               std::vector<storage::CommitRecord>& records,
                               std::optional<model::RejectReason> rejected, TicketRef ticket) {
  Waiting sample{.first = last_seq_ + 1,
                 .last = last_seq_ + records.size(),
                 .mark = mark,
                 .use = {.records = records.size(), .bytes = 0},
                 .rejected = rejected,
                 .ticket = std::move(ticket)};
  for (storage::CommitRecord& record : records) {
    record.seq = ++last_seq_;
    record.sample = mark;
    sample.use.bytes += journal::CostOf(record);
  }
  use_ = use_ + sample.use;
  calls_.AddWaiting(sample.use);
  waiting_.push_back(std::move(sample));
  return waiting_.back().ticket;
}

TicketRef WaitingSamples::Find(std::uint32_t type, const storage::SampleDigest* digest) const {
  for (auto at = waiting_.rbegin(); at != waiting_.rend(); ++at) {
    const Waiting& sample = *at;
    if (sample.mark->is_question || sample.mark->type != type) continue;
    if (digest == nullptr || sample.mark->digest == *digest) return sample.ticket;
    // Without times, an equal sample is a repetition only right after the first.
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
      return;  // OnFenced handles it
  }
}

void WaitingSamples::Finish(Waiting& sample, Settling& settling) {
  Ticket& ticket = *sample.ticket;
  ticket.state = Ticket::State::kCommitted;
  EndUse(sample.use);
  std::ranges::copy(ticket.callers, std::back_inserter(settling.wake));
  if (sample.mark->is_question) {
    // The calls that asked were counted.
    question_on_its_way_ = false;
    return;
  }
  ticket.was_stored = sample.duplicate && !sample.stored;
  // The store may keep one record and refuse another, such as a fault past its bound. Then the
  // sample counts as stored.
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
    // A sample without an outcome was fenced; OnFenced follows.
    while (!waiting_.empty() && waiting_.front().last < one.seq) VoidFront(settling);
    // Samples that became void earlier are gone.
    if (waiting_.empty() || one.seq < waiting_.front().first) continue;
    Waiting& sample = waiting_.front();
    Note(one, sample);
    if (one.seq < sample.last) continue;
    Finish(sample, settling);
    waiting_.pop_front();
  }
  return settling;
}

std::vector<loop::StreamRef> WaitingSamples::VoidQuestions() {
  std::vector<loop::StreamRef> wake;
  const auto end = [&wake](TicketRef& ticket) {
    ticket->state = Ticket::State::kVoid;
    std::ranges::copy(ticket->callers, std::back_inserter(wake));
  };
  if (question_ != nullptr) end(question_);
  question_.reset();
  for (Waiting& sample : waiting_) {
    if (!sample.mark->is_question) continue;
    end(sample.ticket);
    // The record is on its way: no call waits for its outcome.
    sample.ticket = std::make_shared<Ticket>();
  }
  return wake;
}

WaitingSamples::Settling WaitingSamples::VoidAll() {
  Settling settling{.wake = VoidQuestions()};
  while (!waiting_.empty()) VoidFront(settling);
  return settling;
}

void WaitingSamples::VoidFront(Settling& settling) {
  Waiting& sample = waiting_.front();
  sample.ticket->state = robot::Planted(robot::Mutation::kFencedSampleAnswered)
                             ? Ticket::State::kCommitted
                             : Ticket::State::kVoid;
  std::ranges::copy(sample.ticket->callers, std::back_inserter(settling.wake));
  if (sample.mark->is_question) {
    question_on_its_way_ = false;
  } else {
    --settling.counts.in_flight;
    ++settling.counts.refused;
  }
  EndUse(sample.use);
  waiting_.pop_front();
}

void WaitingSamples::EndUse(const robot::JournalUse& use) {
  calls_.EndWaiting(use);
  use_ = {.records = use_.records - use.records, .bytes = use_.bytes - use.bytes};
}

}  // namespace uplink::uncrew
