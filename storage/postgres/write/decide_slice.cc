#include "storage/postgres/write/decide_slice.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <tuple>
#include <utility>
#include <variant>

#include "schema/base/check.h"
#include "storage/expiry.h"

namespace uplink::storage::postgres {
namespace {

using EntryView = KnownRows::EntryView;

EntryView ViewOf(const PresentKey& key) { return {key.ruri, key.id, key.source}; }

KnownRows::Entry EntryOf(const PresentKey& key) {
  return {std::string(key.ruri), std::string(key.id), std::string(key.source)};
}

/// What is known, as decisions ask for it. Nothing of it fails: all was read before.
class KnownByRows final : public Known {
 public:
  KnownByRows(KnownRows& known, BatchRows& rows) : known_(known), rows_(rows) {}

  absl::StatusOr<KnownRobot*> Robot(std::string_view ruri) override {
    const auto robot = known_.robots.find(ruri);
    return robot == known_.robots.end() ? nullptr : &robot->second;
  }
  absl::StatusOr<KnownSession*> Session(const CommitRecord& record) override {
    return &known_.sessions[{record.robot->ruri, record.session}];
  }
  absl::StatusOr<std::optional<model::Rejection>> Rejected(const CommitRecord& record) override {
    const auto why = known_.rejected.find({record.robot->ruri, record.session, record.seq});
    if (why == known_.rejected.end()) return std::optional<model::Rejection>();
    return std::optional(why->second);
  }
  absl::StatusOr<KnownSamples*> Samples(const CommitRecord& record) override {
    const std::uint32_t type = record.sample->type;
    KnownSamples& samples = known_.samples[{record.robot->ruri, type}];
    samples.memory.type = type;
    return &samples;
  }
  absl::StatusOr<KnownRobot::RequestIds> OpenRequests(std::string_view ruri) override {
    const auto ids = known_.open_requests.find(ruri);
    return ids == known_.open_requests.end() ? KnownRobot::RequestIds() : ids->second;
  }
  absl::StatusOr<Epoch> LeaseEpoch(std::string_view client_id) override {
    const auto lease = known_.leases.find(client_id);
    return lease == known_.leases.end() ? Epoch{0} : lease->second;
  }
  absl::StatusOr<std::optional<std::int64_t>> ExpiryOf(const PresentKey& key) override {
    const KnownRows::Entries& entries = known_.entries(key.kind);
    const auto entry = entries.find(ViewOf(key));
    if (entry == entries.end()) return std::optional<std::int64_t>();
    return std::optional(entry->second);
  }
  absl::StatusOr<std::size_t> Count(PresentKind kind, std::string_view ruri) override {
    const auto robot = known_.robots.find(ruri);
    if (robot == known_.robots.end()) return 0;
    return robot->second.counts[static_cast<std::size_t>(kind)].value_or(0);
  }
  absl::Status Delete(const PresentKey& key) override {
    // The upsert that follows sees to it that the row goes (present_rows.h).
    KnownRows::Entries& entries = known_.entries(key.kind);
    entries.erase(entries.find(ViewOf(key)));
    return absl::OkStatus();
  }
  absl::StatusOr<std::size_t> DeleteExpired(PresentKind kind, std::string_view ruri,
                                            std::int64_t now_ms) override {
    KnownRows::Entries& entries = known_.entries(kind);
    std::size_t deleted = 0;
    auto entry = entries.lower_bound(EntryView{ruri, {}, {}});
    while (entry != entries.end() && std::get<0>(entry->first) == ruri) {
      if (!IsExpired(entry->second, now_ms)) {
        ++entry;
        continue;
      }
      // The views must outlive the batch's rows; no record names this id.
      const PresentKey key = {
          kind, known_.Keep(std::get<0>(entry->first)), known_.Keep(std::get<1>(entry->first)), {}};
      rows_.Drop(key);
      entry = entries.erase(entry);
      ++deleted;
    }
    return deleted;
  }

 private:
  KnownRows& known_;
  BatchRows& rows_;
};

/// The answer of a Known that never fails.
template <typename T>
T ValueOrDie(absl::StatusOr<T> answer) {
  UPLINK_CHECK(answer.ok(), "what was read before is known");
  return *std::move(answer);
}

class SliceDecision final {
 public:
  SliceDecision(KnownRows& known, const StoreRules& rules,
                const std::optional<DatabaseRefusal>& refusal, BatchRows& rows)
      : known_(known),
        refusal_(refusal),
        rows_(rows),
        known_by_rows_(known, rows),
        decider_(known_by_rows_, rules) {}

  /// Decider::ResumeSample.
  void ResumeSample(const CommitRecord& before, const Outcome& outcome) {
    decider_.ResumeSample(before, outcome);
  }

  Outcome Decide(const CommitRecord& record, std::int32_t place) {
    std::optional<Outcome> earlier = ValueOrDie(decider_.Look(record));
    if (earlier) return *std::move(earlier);
    if (const auto* item = std::get_if<QuarantineItem>(&record.content)) {
      Reject(record, item->rejection, place);
      return {};
    }
    if (const auto* range = std::get_if<LimitedRange>(&record.content)) {
      Limit(record, *range, place);
      return {};
    }
    Ruling ruling;
    if (refusal_) {
      ruling.refusal = refusal_->rejection;
    } else {
      ruling = ValueOrDie(decider_.Judge(record));
    }
    if (ruling.refusal) {
      Reject(record, *ruling.refusal, place);
      return {OutcomeKind::kRefused, std::move(ruling.refusal)};
    }
    rows_.Write(record, place);
    if (ruling.change) Follow(*ruling.change);
    return {};
  }

  /// `of_records` has the outcomes of all of the batch's records.
  void DecideRest(const Batch& batch, std::span<const Outcome> of_records,
                  std::vector<Outcome>& outcomes) {
    std::size_t place = batch.records.size();
    for (const GapItem& gap : batch.gaps) {
      if (ValueOrDie(decider_.Takes(gap))) rows_.AddGap(gap, static_cast<std::int32_t>(place));
      ++place;
    }
    for (const ConnectionItem& item : batch.connections) {
      rows_.AddConnection(item, static_cast<std::int32_t>(place++));
    }
    rows_.Remember(ValueOrDie(decider_.Remember(batch, of_records)));
    if (batch.presence.empty()) return;
    KnownSession& session = known_.sessions[{std::string(kServerRuri), batch.presence_session}];
    for (const PresenceItem& item : batch.presence) {
      const OutcomeKind outcome = ValueOrDie(decider_.Decide(item, session));
      outcomes.push_back({outcome, std::nullopt});
      if (outcome == OutcomeKind::kStored) {
        rows_.AddPresence(item, batch.presence_session, static_cast<std::int32_t>(place));
      }
      ++place;
    }
  }

 private:
  void Reject(const CommitRecord& record, const model::Rejection& rejection, std::int32_t place) {
    const QuarantineDetail detail = refusal_ ? refusal_->detail : QuarantineDetail::kAll;
    rows_.Reject(record, rejection, detail, place);
    known_.rejected[{record.robot->ruri, record.session, record.seq}] = rejection;
  }
  void Limit(const CommitRecord& record, const LimitedRange& range, std::int32_t place) {
    rows_.Limit(record, range, place);
    for (model::Seq seq = range.first; seq <= record.seq; ++seq) {
      known_.rejected[{record.robot->ruri, record.session, seq}] = range.rejection;
    }
  }
  void Follow(const PresentChange& change) {
    KnownRows::Entries& entries = known_.entries(change.key.kind);
    const auto entry = entries.find(ViewOf(change.key));
    if (!change.is_upsert) {
      if (entry != entries.end()) entries.erase(entry);
    } else if (entry != entries.end()) {
      entry->second = change.expires_ms;
    } else {
      entries.emplace(EntryOf(change.key), change.expires_ms);
    }
  }

  KnownRows& known_;
  const std::optional<DatabaseRefusal>& refusal_;
  BatchRows& rows_;
  KnownByRows known_by_rows_;
  Decider decider_;
};

}  // namespace

std::vector<Outcome> DecideSlice(const Slice& slice, KnownRows& known, const StoreRules& rules,
                                 const std::optional<DatabaseRefusal>& refusal,
                                 std::span<const Outcome> earlier, BatchRows& rows) {
  UPLINK_CHECK(!refusal || slice.last - slice.first == 1, "a refusal is of one record");
  SliceDecision decision(known, rules, refusal, rows);
  UPLINK_CHECK(earlier.size() == slice.first, "the records before a slice are decided");
  if (slice.first > 0) decision.ResumeSample(slice.batch->records[slice.first - 1], earlier.back());
  std::vector<Outcome> outcomes;
  outcomes.reserve(slice.last - slice.first);
  for (std::size_t place = slice.first; place < slice.last; ++place) {
    outcomes.push_back(
        decision.Decide(slice.batch->records[place], static_cast<std::int32_t>(place)));
  }
  for (const auto& [key, samples] : known.samples) {
    if (samples.is_changed) rows.Keep(key.first, samples);
  }
  if (!slice.with_rest) return outcomes;
  std::vector<Outcome> of_records(earlier.begin(), earlier.end());
  std::ranges::copy(outcomes, std::back_inserter(of_records));
  UPLINK_CHECK(of_records.size() == slice.batch->records.size(), "the rest is of the whole batch");
  decision.DecideRest(*slice.batch, of_records, outcomes);
  return outcomes;
}

}  // namespace uplink::storage::postgres
