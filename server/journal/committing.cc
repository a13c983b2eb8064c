#include "server/journal/committing.h"

#include <algorithm>
#include <chrono>
#include <utility>
#include <variant>

#include "schema/base/check.h"
#include "server/journal/outcomes.h"
#include "storage/store.h"

namespace uplink::journal {
namespace {

double Seconds(SteadyTime::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

bool HoldsSpatial(const storage::Batch& batch) {
  return std::ranges::any_of(batch.records, [](const storage::CommitRecord& record) {
    const auto* good = std::get_if<model::Record>(&record.content);
    return good != nullptr && (std::holds_alternative<model::ShapeOp>(good->body()) ||
                               std::holds_alternative<model::ObjectOp>(good->body()));
  });
}

}  // namespace

Committing::Committing(const WriterContext& context, Holds& holds, const Limits& limits,
                       const model::SessionId& presence_session)
    : context_(context),
      holds_(holds),
      limits_(limits),
      size_({.most = limits.records_max}),
      batch_(presence_session) {}

bool Committing::Gather() {
  if (batch_.empty()) {
    batch_ = context_.inbox.Fill(std::move(batch_),
                                 {.records_max = size_.now(),
                                  .bytes_max = limits_.bytes_max,
                                  .robot = limits_.robot,
                                  .gateway = limits_.gateway},
                                 holds_.robots());
  }
  return HasBatch();
}

Step Committing::Commit() {
  DropVoid();
  // No entry comes into a batch before its robot is held, and losing a hold makes entries void.
  batch_.SetHolds(holds_.robots());
  const SteadyTime began = context_.clock.Steady();
  auto outcomes = context_.store.Commit(batch_.batch());
  context_.errors.NoteCall(outcomes.status());
  if (!outcomes.ok()) {
    batch_.MarkTried();
    if (size_.Failed(batch_.longest())) context_.inbox.PutBack(batch_.TakeRest(size_.now()));
    return Step::kFailed;
  }
  size_.Succeeded();
  const std::size_t records = batch_.batch().records.size();
  UPLINK_CHECK(outcomes->size() == records + batch_.batch().presence.size(),
               "the store answers every record and change of presence");
  const SteadyTime::duration took = context_.clock.Steady() - began;
  context_.probe.commit_seconds.Observe(Seconds(took));
  if (took >= kSlowCommit && context_.slow_commit) {
    context_.slow_commit({.records = records,
                          .presence_changes = batch_.batch().presence.size(),
                          .took = std::chrono::duration_cast<milliseconds>(took)});
  }
  context_.probe.commit_records.Observe(static_cast<double>(records));
  context_.probe.runs_closed_for_bound.Add(
      static_cast<std::int64_t>(context_.store.TakeRunsClosed()));
  FinishPresence(std::span(*outcomes).subspan(records));
  const std::size_t connections = batch_.batch().connections.size();
  context_.probe.connections_written.Add(static_cast<std::int64_t>(connections));
  context_.inbox.CountConnectionsCommitted(connections);
  batch_.ClearConnections();
  NoteQuarantined(*outcomes);
  outcomes->resize(records);
  outcomes_ = *std::move(outcomes);
  return Step::kWorked;
}

void Committing::PutBack() { context_.inbox.PutBack(batch_.TakeRest(0)); }

void Committing::DropVoid() {
  const GatheredBatch::Dropped dropped = batch_.DropVoid();
  // Their robots' next streams may be held back for them.
  for (const robot::ClientRef& client : dropped.gap_clients) client->OnGapsWritten(1).Wake();
  if (dropped.entries == 0) return;
  context_.inbox.Release(
      {.records = dropped.entries, .bytes = dropped.bytes, .batch_ended = batch_.entries() == 0});
}

void Committing::NoteQuarantined(std::span<const storage::Outcome> outcomes) {
  const std::vector<storage::CommitRecord>& records = batch_.batch().records;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const bool was_bad = std::holds_alternative<storage::QuarantineItem>(records[i].content);
    const bool quarantined = outcomes[i].kind == storage::OutcomeKind::kRefused ||
                             (was_bad && outcomes[i].kind == storage::OutcomeKind::kStored);
    if (quarantined) context_.quarantine.Note(records[i].robot->ruri);
  }
}

void Committing::FinishPresence(std::span<const storage::Outcome> outcomes) {
  const std::vector<storage::PresenceItem>& items = batch_.batch().presence;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const bool refused = outcomes[i].kind == storage::OutcomeKind::kFenced;
    metrics::Cell& written =
        context_.probe.presence_changes[static_cast<std::size_t>(items[i].presence)];
    if (refused) {
      context_.probe.presence_refused.Add();
    } else if (items[i].changes_presence) {
      written.Add();
    }
    // No other step may notice it: nothing is committed of a robot that sends only live messages.
    if (refused) holds_.LoseSince(items[i].robot->ruri, items[i].held_since).Wake();
  }
  context_.inbox.CountPresenceCommitted(items.size());
  batch_.ClearPresence();
}

void Committing::Tell() {
  const std::vector<loop::StreamRef> wake =
      TellOutcomes(batch_, *std::exchange(outcomes_, std::nullopt), holds_, context_.ledger);
  const bool spatial = HoldsSpatial(batch_.batch());
  const WriterInbox::Done done{
      .records = batch_.entries(), .bytes = batch_.bytes(), .batch_ended = true};
  batch_.ClearEntries();
  context_.inbox.Release(done);
  for (const loop::StreamRef stream : wake) stream.Wake();
  if (spatial && context_.spatial_committed) context_.spatial_committed();
}

}  // namespace uplink::journal
