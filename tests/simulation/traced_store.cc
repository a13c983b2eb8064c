#include "tests/simulation/traced_store.h"

#include <string>
#include <variant>

#include <absl/strings/escaping.h>
#include <fmt/format.h>

namespace uplink::simulation {
namespace {

std::string TextOf(const model::Rejection& rejection) {
  return fmt::format("{} \"{}\" \"{}\"", model::ToText(rejection.reason), rejection.field,
                     rejection.detail);
}

std::string TextOf(const storage::OpenRequest& request) {
  std::string text = fmt::format("open {} session {} settled {} at {} holding", request.robot->ruri,
                                 request.session.ToHex(), request.settled_seq, UnixMs(request.at));
  for (const model::SessionId& held : request.sessions_held) text += " " + held.ToHex();
  return text;
}

std::string TextOf(const storage::OpenResult& result) {
  std::string text = fmt::format("opened epoch {} held since {} cursor {} rejects {}", result.epoch,
                                 result.held_since, result.cursor, result.rejects_total);
  for (const storage::StoredReject& reject : result.rejects) {
    text += fmt::format(", {} {}", reject.seq, TextOf(reject.rejection));
  }
  return text;
}

/// The payload stands for the whole record, which was made from it.
std::string TextOf(const storage::CommitRecord& record) {
  std::string text = fmt::format(
      "record {} session {} seq {} held since {} received {} payload {} of {} bytes",
      record.robot->ruri, record.session.ToHex(), record.seq, record.held_since,
      UnixMs(record.received_at), absl::BytesToHexString(record.payload), record.payload_bytes);
  if (record.sample != nullptr) {
    text +=
        fmt::format(" sample of type {} under claim {}", record.sample->type, record.sample->claim);
  }
  if (const auto* item = std::get_if<storage::QuarantineItem>(&record.content)) {
    return text + " quarantine " + TextOf(item->rejection);
  }
  if (const auto* range = std::get_if<storage::LimitedRange>(&record.content)) {
    return text + fmt::format(" limited from {} ", range->first) + TextOf(range->rejection);
  }
  if (std::holds_alternative<model::ScopeUpdate>(record.content)) return text + " scope update";
  if (std::holds_alternative<model::OperatorRequest>(record.content)) return text + " request";
  const auto& good = std::get<model::Record>(record.content);
  return text + fmt::format(" variant {}", static_cast<int>(good.variant()));
}

std::string TextOf(const storage::GapItem& gap) {
  return fmt::format("gap {} session {} from {} to {} held since {} seen {}", gap.robot->ruri,
                     gap.session.ToHex(), gap.first, gap.last, gap.held_since, UnixMs(gap.seen_at));
}

std::string TextOf(const storage::PresenceItem& item) {
  return fmt::format("presence {} {} at {} number {}", item.robot->ruri,
                     model::ToText(item.presence), UnixMs(item.at), item.number);
}

std::string TextOf(const storage::Outcome& outcome) {
  return fmt::format("outcome {} {}", static_cast<int>(outcome.kind),
                     outcome.rejection ? TextOf(*outcome.rejection) : "");
}

std::string TextOf(const storage::LiveRow& row) {
  std::string text = fmt::format("live {}", row.ruri);
  if (row.last_sign_of_life) text += fmt::format(" alive {}", UnixMs(*row.last_sign_of_life));
  if (row.clock_skew_ms) text += fmt::format(" skew {}", *row.clock_skew_ms);
  if (row.session) {
    text += fmt::format(" session {} settled {}", row.session->session.ToHex(),
                        row.session->settled_seq);
  }
  for (std::size_t part = 0; part < row.parts.size(); ++part) {
    if (!row.parts[part]) continue;
    text += fmt::format(" part {} {}", part, absl::BytesToHexString(*row.parts[part]));
  }
  return text;
}

/// The answer as it is returned, written on its way: `add` writes what it holds if it is good.
template <typename Answer, typename Add>
absl::StatusOr<Answer> Traced(Trace& trace, absl::StatusOr<Answer> answer, const Add& add) {
  if (answer.ok()) {
    add(*answer);
  } else {
    // The code alone: a message may name a temporary file, which is another one in each run.
    trace.Add("failed " + absl::StatusCodeToString(answer.status().code()));
  }
  return answer;
}

}  // namespace

absl::StatusOr<std::vector<storage::OpenResult>> TracedStore::OpenStreams(
    std::span<const storage::OpenRequest> requests) {
  trace_.Add(fmt::format("store OpenStreams of {}", requests.size()));
  for (const storage::OpenRequest& request : requests) trace_.Add(TextOf(request));
  return Traced(trace_, store_.OpenStreams(requests), [this](const auto& results) {
    for (const storage::OpenResult& result : results) trace_.Add(TextOf(result));
  });
}

absl::StatusOr<std::vector<storage::AdoptResult>> TracedStore::Adopt(
    std::span<const storage::AdoptRequest> requests) {
  trace_.Add(fmt::format("store Adopt of {}", requests.size()));
  for (const storage::AdoptRequest& request : requests) {
    trace_.Add(fmt::format("adopt {}", request.robot->ruri));
  }
  return Traced(trace_, store_.Adopt(requests), [this](const auto& results) {
    for (const storage::AdoptResult& result : results) {
      trace_.Add(fmt::format("held since {}", result.held_since.value_or(0)));
    }
  });
}

absl::StatusOr<std::vector<storage::ClaimResult>> TracedStore::ClaimDrones(
    std::span<const storage::ClaimRequest> requests) {
  trace_.Add(fmt::format("store ClaimDrones of {}", requests.size()));
  for (const storage::ClaimRequest& request : requests) {
    trace_.Add(fmt::format("claim {}", request.robot->ruri));
  }
  return Traced(trace_, store_.ClaimDrones(requests), [this](const auto& results) {
    for (const storage::ClaimResult& result : results) {
      trace_.Add(fmt::format("claim {}, held since {}", result.claim, result.held_since));
    }
  });
}

void TracedStore::AddBatch(const storage::Batch& batch) {
  trace_.Add(fmt::format("store Commit by {}", batch.presence_session.ToHex()));
  for (const storage::CommitRecord& record : batch.records) trace_.Add(TextOf(record));
  for (const storage::GapItem& gap : batch.gaps) trace_.Add(TextOf(gap));
  for (const storage::PresenceItem& item : batch.presence) trace_.Add(TextOf(item));
}

absl::StatusOr<std::vector<storage::Outcome>> TracedStore::Commit(const storage::Batch& batch) {
  AddBatch(batch);
  return Traced(trace_, store_.Commit(batch), [this](const auto& outcomes) {
    for (const storage::Outcome& outcome : outcomes) trace_.Add(TextOf(outcome));
  });
}

absl::StatusOr<storage::Swept> TracedStore::Sweep(SystemTime now) {
  trace_.Add(fmt::format("store Sweep at {}", UnixMs(now)));
  return Traced(trace_, store_.Sweep(now), [this](const storage::Swept& swept) {
    trace_.Add(fmt::format("swept {}", swept.items));
  });
}

absl::StatusOr<std::size_t> TracedStore::CloseRuns(SystemTime now) {
  trace_.Add(fmt::format("store CloseRuns at {}", UnixMs(now)));
  return Traced(trace_, store_.CloseRuns(now),
                [this](std::size_t rows) { trace_.Add(fmt::format("closed {}", rows)); });
}

absl::StatusOr<std::vector<storage::ProcessId>> TracedStore::ProcessesWithOpenConnections() {
  return store_.ProcessesWithOpenConnections();
}

absl::StatusOr<std::size_t> TracedStore::EndConnections(const storage::ProcessId& process,
                                                        SystemTime now) {
  return store_.EndConnections(process, now);
}

std::size_t TracedStore::TakeRunsClosed() { return store_.TakeRunsClosed(); }

absl::StatusOr<storage::Trimmed> TracedStore::TrimQuarantine(std::span<const std::string> ruris) {
  trace_.Add(fmt::format("store TrimQuarantine of {}", fmt::join(ruris, " ")));
  return Traced(trace_, store_.TrimQuarantine(ruris), [this](const storage::Trimmed& trimmed) {
    trace_.Add(fmt::format("dropped {}", fmt::join(trimmed.dropped, " ")));
  });
}

absl::StatusOr<storage::Erased> TracedStore::Retain(SystemTime now) {
  trace_.Add(fmt::format("store Retain at {}", UnixMs(now)));
  return Traced(trace_, store_.Retain(now), [this](const storage::Erased& went) {
    trace_.Add(fmt::format("removed {}", went.rows));
  });
}

absl::StatusOr<std::vector<std::size_t>> TracedStore::Checkpoint(
    std::span<const storage::LiveRow> rows) {
  trace_.Add(fmt::format("store Checkpoint of {}", rows.size()));
  for (const storage::LiveRow& row : rows) trace_.Add(TextOf(row));
  return Traced(trace_, store_.Checkpoint(rows), [this](const auto& passed_over) {
    trace_.Add(fmt::format("passed over {}", fmt::join(passed_over, " ")));
  });
}

bool TracedStore::InDoubt() const { return store_.InDoubt(); }

absl::StatusOr<std::vector<storage::FoundRobot>> TracedStore::Compare(
    std::span<const storage::ToldRobot> robots) {
  trace_.Add(fmt::format("store Compare of {}", robots.size()));
  return Traced(trace_, store_.Compare(robots), [this](const auto& found) {
    for (const storage::FoundRobot& robot : found) {
      trace_.Add(fmt::format("found held {} went back {}", robot.held, robot.went_back));
    }
  });
}

void TracedStore::EndDoubt() { store_.EndDoubt(); }

}  // namespace uplink::simulation
