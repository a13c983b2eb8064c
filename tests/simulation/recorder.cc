#include "tests/simulation/recorder.h"

#include <algorithm>

#include <fmt/format.h>

namespace uplink::simulation {

absl::StatusOr<std::vector<storage::OpenResult>> Recorder::OpenStreams(
    std::span<const storage::OpenRequest> requests) {
  const StoreFault fault = std::exchange(fault_, StoreFault::kNone);
  if (away_ || fault == StoreFault::kBefore) return absl::UnavailableError("ordered");
  auto results = store_->OpenStreams(requests);
  if (!results.ok()) return results;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const DurableSession& durable = Of(requests[i].robot->ruri, requests[i].session);
    if ((*results)[i].cursor != durable.cursor) {
      violation_(fmt::format("the cursor of session {} is {}, but {} was committed",
                             requests[i].session.ToHex(), (*results)[i].cursor, durable.cursor));
    }
  }
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const bool first =
        book_.rows.insert_or_assign(requests[i].robot->ruri, (*results)[i].held_since).second;
    if ((*results)[i].was_known != first) continue;
    violation_(fmt::format("a row of {} was {}", requests[i].robot->ruri,
                           first ? "known, and there was none" : "new, and there was one"));
  }
  if (fault == StoreFault::kAfter) return absl::UnavailableError("ordered, answer lost");
  return results;
}

void Recorder::GoBack(std::function<void()> reconnected) {
  if (!reconnected_) before_ = std::move(book_);
  book_ = copy_;
  // Changes of presence between are lost.
  book_.skips_presence = true;
  reconnected_ = std::move(reconnected);
}

void Recorder::Reconnect() {
  if (!reconnected_) return;
  // Until it has returned, the process did not know.
  reconnected_();
  reconnected_ = nullptr;
  before_ = {};
}

bool Recorder::MayBeTold(const std::string& ruri, const model::SessionId& session, model::Seq seq) {
  if (Of(ruri, session).Holds(seq)) return true;
  return reconnected_ && before_.sessions[{ruri, session}].Holds(seq);
}

bool Recorder::OnRowDeleted(const std::string& ruri) {
  const bool deleted = book_.rows.erase(ruri) > 0;
  book_.skips_presence = book_.skips_presence || deleted;
  return deleted;
}

void Recorder::CheckHold(const std::string& ruri, storage::Epoch held_since,
                         storage::OutcomeKind outcome) {
  const auto row = book_.rows.find(ruri);
  const bool held = row != book_.rows.end() && held_since == row->second;
  if (held && outcome == storage::OutcomeKind::kFenced) violation_("one process alone was fenced");
  if (held || outcome == storage::OutcomeKind::kFenced) return;
  violation_(fmt::format("{} is not held, and something of it was taken", ruri));
}

absl::StatusOr<std::vector<storage::AdoptResult>> Recorder::Adopt(
    std::span<const storage::AdoptRequest> requests) {
  const StoreFault fault = std::exchange(fault_, StoreFault::kNone);
  if (away_ || fault == StoreFault::kBefore) return absl::UnavailableError("ordered");
  auto results = store_->Adopt(requests);
  if (!results.ok()) return results;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const auto& since = (*results)[i].held_since;
    if (since) book_.rows.insert_or_assign(requests[i].robot->ruri, *since);
  }
  if (fault == StoreFault::kAfter) return absl::UnavailableError("ordered, answer lost");
  return results;
}

absl::StatusOr<std::vector<storage::ClaimResult>> Recorder::ClaimDrones(
    std::span<const storage::ClaimRequest> requests) {
  const StoreFault fault = std::exchange(fault_, StoreFault::kNone);
  if (away_ || fault == StoreFault::kBefore) return absl::UnavailableError("ordered");
  auto results = store_->ClaimDrones(requests);
  if (!results.ok()) return results;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const storage::Epoch since = (*results)[i].held_since;
    if (since != 0) book_.rows.insert_or_assign(requests[i].robot->ruri, since);
  }
  if (fault == StoreFault::kAfter) return absl::UnavailableError("ordered, answer lost");
  return results;
}

absl::StatusOr<std::vector<storage::Outcome>> Recorder::Commit(const storage::Batch& batch) {
  const StoreFault fault = std::exchange(fault_, StoreFault::kNone);
  if (away_ || fault == StoreFault::kBefore) return absl::UnavailableError("ordered");
  auto outcomes = store_->Commit(batch);
  if (!outcomes.ok()) return outcomes;
  for (std::size_t i = 0; i < batch.records.size(); ++i) Note(batch.records[i], (*outcomes)[i]);
  NotePresence(batch, std::span(*outcomes).subspan(batch.records.size()));
  if (fault == StoreFault::kAfter) return absl::UnavailableError("ordered, answer lost");
  return outcomes;
}

absl::StatusOr<storage::Swept> Recorder::Sweep(SystemTime now) {
  const StoreFault fault = std::exchange(fault_, StoreFault::kNone);
  if (away_ || fault == StoreFault::kBefore) return absl::UnavailableError("ordered");
  auto deleted = store_->Sweep(now);
  if (fault == StoreFault::kAfter) return absl::UnavailableError("ordered, answer lost");
  return deleted;
}

absl::StatusOr<std::size_t> Recorder::CloseRuns(SystemTime now) {
  if (away_) return absl::UnavailableError("ordered");
  return store_->CloseRuns(now);
}

absl::StatusOr<std::vector<storage::ProcessId>> Recorder::ProcessesWithOpenConnections() {
  if (away_) return absl::UnavailableError("ordered");
  return store_->ProcessesWithOpenConnections();
}

absl::StatusOr<std::size_t> Recorder::EndConnections(const storage::ProcessId& process,
                                                     SystemTime now) {
  if (away_) return absl::UnavailableError("ordered");
  return store_->EndConnections(process, now);
}

std::size_t Recorder::TakeRunsClosed() { return store_->TakeRunsClosed(); }

absl::StatusOr<storage::Trimmed> Recorder::TrimQuarantine(std::span<const std::string> ruris) {
  if (away_) return absl::UnavailableError("ordered");
  return store_->TrimQuarantine(ruris);
}

absl::StatusOr<storage::Erased> Recorder::Retain(SystemTime now) {
  if (away_) return absl::UnavailableError("ordered");
  return store_->Retain(now);
}

absl::StatusOr<std::vector<std::size_t>> Recorder::Checkpoint(
    std::span<const storage::LiveRow> rows) {
  if (away_) return absl::UnavailableError("ordered");
  return store_->Checkpoint(rows);
}

bool Recorder::InDoubt() const { return store_->InDoubt(); }

absl::StatusOr<std::vector<storage::FoundRobot>> Recorder::Compare(
    std::span<const storage::ToldRobot> robots) {
  if (away_) return absl::UnavailableError("ordered");
  return store_->Compare(robots);
}

void Recorder::EndDoubt() {
  Reconnect();
  store_->EndDoubt();
}

void Recorder::SetStore(storage::Store* store) {
  store_ = store;
  // A new process knows nothing of the store before.
  Reconnect();
}

void Recorder::NotePresence(const storage::Batch& batch,
                            std::span<const storage::Outcome> outcomes) {
  model::Seq& cursor = book_.presence_cursors[batch.presence_session];
  for (std::size_t i = 0; i < batch.presence.size(); ++i) {
    const storage::PresenceItem& item = batch.presence[i];
    CheckHold(item.robot->ruri, item.held_since, outcomes[i].kind);
    if (item.number <= cursor) continue;
    if (item.number != cursor + 1 && !book_.skips_presence) {
      violation_(fmt::format("change of presence {} follows {}", item.number, cursor));
    }
    cursor = item.number;
    if (outcomes[i].kind == storage::OutcomeKind::kFenced) continue;
    if (!item.changes_presence) continue;
    const auto [last, first] = book_.presence.try_emplace(item.robot->ruri, item.presence);
    if (!first && last->second == item.presence) {
      violation_(fmt::format("{} is {} twice in a row", item.robot->ruri, ToText(item.presence)));
    }
    last->second = item.presence;
    book_.presence_history[item.robot->ruri].push_back(item.presence);
  }
}

void Recorder::Note(const storage::CommitRecord& record, const storage::Outcome& outcome) {
  CheckHold(record.robot->ruri, record.held_since, outcome.kind);
  DurableSession& durable = book_.sessions[{record.robot->ruri, record.session}];
  const bool quarantined = std::holds_alternative<storage::QuarantineItem>(record.content);
  const auto* limited = std::get_if<storage::LimitedRange>(&record.content);
  switch (outcome.kind) {
    case storage::OutcomeKind::kStored:
      if (durable.Holds(record.seq)) {
        violation_(fmt::format("number {} of session {} was stored twice", record.seq,
                               record.session.ToHex()));
      }
      if (limited != nullptr) {
        for (model::Seq seq = limited->first; seq <= record.seq; ++seq) {
          durable.quarantined.emplace(seq, limited->rejection.reason);
        }
      } else if (quarantined) {
        durable.quarantined.emplace(
            record.seq, std::get<storage::QuarantineItem>(record.content).rejection.reason);
      } else {
        durable.stored.insert(record.seq);
        const auto& good = std::get<model::Record>(record.content);
        if (good.variant() == model::Variant::kFault) ++durable.faults;
        book_.shared.Note(record);
      }
      break;
    case storage::OutcomeKind::kRefused:
      durable.quarantined.emplace(record.seq, outcome.rejection->reason);
      if (durable.stored.contains(record.seq)) {
        violation_(fmt::format("number {} was stored and is refused now", record.seq));
      }
      break;
    case storage::OutcomeKind::kDuplicate:
      if (!durable.stored.contains(record.seq)) {
        violation_(fmt::format("number {} is called a duplicate and was never stored", record.seq));
      }
      return;
    case storage::OutcomeKind::kFenced:
      return;
  }
  durable.cursor = std::max(durable.cursor, record.seq);
}

}  // namespace uplink::simulation
