#include "storage/postgres/write/batch_commit.h"

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <variant>

#include "schema/base/check.h"
#include "storage/postgres/write/transaction.h"
#include "storage/postgres/write/upkeep.h"
#include "storage/refusal.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kDoing = "commit a batch";
constexpr std::string_view kSavepoint = "SAVEPOINT part";
constexpr std::string_view kRelease = "RELEASE SAVEPOINT part";
constexpr std::string_view kRollBackTo = "ROLLBACK TO SAVEPOINT part";

constexpr std::string_view kBeginBatch =
    "SELECT uplinkd.begin_batch($1::text[], $2::bigint[], $3::text[], $4::uuid[], $5::bigint[],"
    " $6::text[], $7::int[], $8::int[], $9::int[], $10::bigint, $11::bigint, $12::bigint,"
    " $13::uuid, $14::bigint, $15::uuid)";

/// What begin_batch checks, gathered from a batch.
struct Premises {
  /// Upserts, by PresentKind.
  using Counts = std::array<std::int32_t, kPresentKinds>;
  std::map<std::string_view, Epoch> holds;
  std::map<std::pair<std::string_view, model::SessionId>, model::Seq> first_numbers;
  std::map<std::string_view, Counts> bounded;

  /// False if the batch has another hold of the robot, too: one of them does not stand.
  bool AddHold(std::string_view ruri, Epoch held_since) {
    return holds.try_emplace(ruri, held_since).first->second == held_since;
  }
  void AddBounded(const PresentChange& change) {
    if (change.is_upsert) ++bounded[change.key.ruri][static_cast<std::size_t>(change.key.kind)];
  }
};

StoreCall BeginBatchCall(const Premises& premises, const Batch& batch, const ProcessId& process) {
  Array robots{Type::kText}, holds{Type::kInt8};
  for (const auto& [ruri, held] : premises.holds) {
    robots.Text(ruri);
    holds.Int8(held);
  }
  Array session_robots{Type::kText}, session_ids{Type::kUuid}, firsts{Type::kInt8};
  for (const auto& [key, first] : premises.first_numbers) {
    session_robots.Text(key.first);
    session_ids.Uuid(key.second);
    firsts.Int8(first);
  }
  Array bounded{Type::kText};
  std::array<Array, kPresentKinds> upserts = {Array(Type::kInt4), Array(Type::kInt4),
                                              Array(Type::kInt4)};
  for (const auto& [ruri, counts] : premises.bounded) {
    bounded.Text(ruri);
    for (std::size_t kind = 0; kind < kPresentKinds; ++kind) upserts[kind].Int4(counts[kind]);
  }
  StoreCall call =
      StoreCallOf(kBeginBatch, &robots, &holds, &session_robots, &session_ids, &firsts, &bounded);
  for (Array& column : upserts) call.parameters.Add(&column);
  for (const PresentKind kind : {PresentKind::kFault, PresentKind::kShape, PresentKind::kObject}) {
    call.parameters.Add(BoundOf(kind).entries_max);
  }
  if (batch.presence.empty()) {
    call.parameters.Add(std::nullopt);
    call.parameters.Add(std::nullopt);
  } else {
    call.parameters.Add(batch.presence_session);
    call.parameters.Add(batch.presence.front().number);
  }
  call.parameters.Add(process);
  return call;
}

}  // namespace

absl::StatusOr<std::vector<Outcome>> BatchCommit::Run() {
  UPLINK_CHECK(batch_.records.size() + batch_.gaps.size() + batch_.presence.size() +
                       batch_.connections.size() <=
                   kPlacesMax,
               "a batch has more rows than a transaction has places");
  absl::StatusOr<Outcomes> outcomes = absl::OutOfRangeError("a number goes back in the batch");
  if (MayWriteAtOnce()) outcomes = WriteAtOnce();
  if (absl::IsOutOfRange(outcomes.status())) outcomes = WriteAfterLook();
  if (absl::IsInvalidArgument(outcomes.status())) outcomes = WriteInHalves();
  return outcomes;
}

bool BatchCommit::MayWriteAtOnce() const {
  std::map<std::pair<std::string_view, model::SessionId>, model::Seq> last;
  for (const CommitRecord& record : batch_.records) {
    if (record.sample != nullptr) return false;
    model::Seq& seq = last[{record.robot->ruri, record.session}];
    if (record.seq <= seq) return false;
    seq = record.seq;
  }
  model::Seq number = 0;
  for (const PresenceItem& item : batch_.presence) {
    if (item.number <= number) return false;
    number = item.number;
  }
  return true;
}

absl::StatusOr<BatchCommit::Outcomes> BatchCommit::WriteAtOnce() {
  Premises premises;
  BatchRows rows(terms_.rules);
  std::int32_t place = 0;
  bool one_hold = true;
  for (const CommitRecord& record : batch_.records) {
    UPLINK_CHECK(record.seq <= model::kSeqMax, "a number past the contract's reached the store");
    const std::string_view ruri = record.robot->ruri;
    one_hold = premises.AddHold(ruri, record.held_since) && one_hold;
    const auto* range = std::get_if<LimitedRange>(&record.content);
    premises.first_numbers.try_emplace({ruri, record.session},
                                       range != nullptr ? range->first : record.seq);
    if (range != nullptr) {
      rows.Limit(record, *range, place++);
    } else if (const auto* item = std::get_if<QuarantineItem>(&record.content)) {
      rows.Reject(record, item->rejection, QuarantineDetail::kAll, place++);
    } else {
      if (const auto change = PresentChangeOf(record, terms_.rules)) premises.AddBounded(*change);
      rows.Write(record, place++);
    }
  }
  for (const GapItem& gap : batch_.gaps) {
    one_hold = premises.AddHold(gap.robot->ruri, gap.held_since) && one_hold;
    rows.AddGap(gap, place++);
  }
  // begin_batch and hold_topics see to it that all of it is stored.
  Outcomes outcomes(batch_.records.size() + batch_.presence.size());
  rows.Remember(*DeliveryChangesOf(batch_, outcomes, [](const TopicHold&) { return true; }));
  for (const PresenceItem& item : batch_.presence) {
    one_hold = premises.AddHold(item.robot->ruri, item.held_since) && one_hold;
    rows.AddPresence(item, batch_.presence_session, place++);
  }
  for (const ConnectionItem& item : batch_.connections) rows.AddConnection(item, place++);
  if (!one_hold) return absl::OutOfRangeError("a robot comes under two holds in one batch");
  std::vector<StoreCall> calls = BeginCalls();
  AddHoldCall(batch_, terms_.process, calls);
  calls.push_back(BeginBatchCall(premises, batch_, terms_.process));
  std::ranges::move(std::move(rows).TakeCalls(), std::back_inserter(calls));
  absl::Status committed = CommitCalls(std::move(calls));
  if (!committed.ok()) return committed;
  return outcomes;
}

absl::StatusOr<BatchCommit::Outcomes> BatchCommit::WriteAfterLook() {
  absl::Status begun = Begin(connection_, kDoing);
  if (!begun.ok()) return begun;
  absl::StatusOr<KnownRows> known = ReadKnown(connection_, Whole(), terms_);
  if (!known.ok()) return Decisive(known.status());
  BatchRows rows(terms_.rules);
  Outcomes outcomes = DecideSlice(Whole(), *known, terms_.rules, std::nullopt, {}, rows);
  std::vector<StoreCall> calls = std::move(rows).TakeCalls();
  calls.push_back({kLogPosition, {}});
  absl::Status committed = CommitCalls(std::move(calls));
  if (!committed.ok()) return committed;
  return outcomes;
}

absl::StatusOr<BatchCommit::Outcomes> BatchCommit::WriteInHalves() {
  absl::Status begun = Begin(connection_, kDoing);
  if (!begun.ok()) return begun;
  Outcomes outcomes;
  outcomes.reserve(batch_.records.size() + batch_.presence.size());
  absl::Status written = Halve({&batch_, 0, batch_.records.size(), false}, outcomes);
  if (written.ok()) {
    // Gaps and changes of presence: what the database refuses of them, no robot can mend.
    const std::size_t end = batch_.records.size();
    auto rest = WriteSlice({&batch_, end, end, true}, std::nullopt, outcomes);
    written = Decisive(rest.status());
    if (rest.ok()) std::ranges::move(*rest, std::back_inserter(outcomes));
  }
  if (!written.ok()) return AbandonAfter(written);
  written = RunAndCommit(connection_, {{kLogPosition, {}}}, kDoing, before_commit_);
  if (!written.ok()) return written;
  return outcomes;
}

absl::Status BatchCommit::CommitCalls(std::vector<StoreCall> calls) {
  const std::optional<std::size_t> closing = PlaceOfCloseRunsOver(calls);
  const auto answers = RunAndCommitFor(connection_, std::move(calls), kDoing, before_commit_);
  if (answers.ok() && closing) runs_closed_ += (*answers)[*closing].written();
  return answers.status();
}

absl::Status BatchCommit::Halve(const Slice& slice, Outcomes& outcomes) {
  if (slice.first == slice.last) return absl::OkStatus();
  absl::StatusOr<Outcomes> written = WriteSlice(slice, std::nullopt, outcomes);
  if (written.ok()) {
    std::ranges::move(*written, std::back_inserter(outcomes));
    return absl::OkStatus();
  }
  if (!absl::IsInvalidArgument(written.status())) return written.status();
  if (slice.last - slice.first == 1) return Isolate(slice, written.status(), outcomes);
  const std::size_t middle = slice.first + (slice.last - slice.first) / 2;
  absl::Status status = Halve({slice.batch, slice.first, middle, false}, outcomes);
  if (status.ok()) status = Halve({slice.batch, middle, slice.last, false}, outcomes);
  return status;
}

absl::Status BatchCommit::Isolate(const Slice& slice, const absl::Status& cause,
                                  Outcomes& outcomes) {
  const absl::string_view text = cause.message();
  DatabaseRefusal refusal{StoreRefused({text.data(), text.size()}), QuarantineDetail::kAll};
  absl::Status last;
  for (const QuarantineDetail detail :
       {QuarantineDetail::kAll, QuarantineDetail::kWithoutPayload, QuarantineDetail::kBare}) {
    refusal.detail = detail;
    absl::StatusOr<Outcomes> written = WriteSlice(slice, refusal, outcomes);
    if (written.ok()) {
      std::ranges::move(*written, std::back_inserter(outcomes));
      return absl::OkStatus();
    }
    if (!absl::IsInvalidArgument(written.status())) return written.status();
    last = written.status();
  }
  return absl::InternalError("quarantine takes not even a bare row: " +
                             std::string(last.message()));
}

absl::StatusOr<BatchCommit::Outcomes> BatchCommit::WriteSlice(
    const Slice& slice, const std::optional<DatabaseRefusal>& refusal,
    std::span<const Outcome> earlier) {
  absl::StatusOr<KnownRows> known = ReadKnown(connection_, slice, terms_);
  if (!known.ok()) return Decisive(known.status());
  BatchRows rows(terms_.rules);
  Outcomes outcomes = DecideSlice(slice, *known, terms_.rules, refusal, earlier, rows);
  std::vector<StoreCall> calls;
  calls.push_back({kSavepoint, {}});
  std::ranges::move(std::move(rows).TakeCalls(), std::back_inserter(calls));
  calls.push_back({kRelease, {}});
  const std::optional<std::size_t> closing = PlaceOfCloseRunsOver(calls);
  const auto answers = connection_.Run(calls, kDoing, OnError::kLeave);
  if (answers.ok()) {
    if (closing) runs_closed_ += (*answers)[*closing].written();
    return outcomes;
  }
  absl::Status written = answers.status();
  if (!absl::IsInvalidArgument(written)) return written;
  calls.clear();
  calls.push_back({kRollBackTo, {}});
  absl::Status rolled_back = connection_.Run(calls, kDoing).status();
  if (!rolled_back.ok()) return rolled_back;
  return written;
}

absl::Status BatchCommit::AbandonAfter(const absl::Status& error) {
  if (connection_.broken()) return error;
  absl::Status rolled_back = connection_.RollBack();
  return rolled_back.ok() ? error : rolled_back;
}

}  // namespace uplink::storage::postgres
