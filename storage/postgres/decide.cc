#include "storage/postgres/decide.h"

#include <string>
#include <utility>
#include <variant>

#include "schema/base/check.h"
#include "storage/expiry.h"
#include "storage/refusal.h"

namespace uplink::storage::postgres {
namespace {

using model::Rejection;

/// Judges one good record by the bounds; `known` follows what passes.
class Bounds final {
 public:
  Bounds(const CommitRecord& record, Known& known, const StoreRules& rules, BatchRows& rows)
      : record_(record), known_(known), rules_(rules), rows_(rows) {}

  std::optional<Rejection> operator()(const model::Fault& fault) {
    const std::string& ruri = record_.robot->ruri;
    std::size_t& count = known_.active_counts[ruri];
    const auto key = std::make_tuple(ruri, fault.fault_id, fault.source);
    const bool was_active = known_.active.contains(key);
    if (!fault.active) {
      count -= known_.active.erase(key);
      return std::nullopt;
    }
    if (was_active) return std::nullopt;
    if (count >= kActiveFaultsPerRobotMax) return TooManyActiveFaults();
    known_.active.insert(key);
    ++count;
    return std::nullopt;
  }
  std::optional<Rejection> operator()(const model::ShapeOp& op) {
    if (op.upsert() == nullptr) return Remove(known_.shapes, op.id());
    const auto drop = [this](std::string_view id) { rows_.DropShape(record_.robot->ruri, id); };
    if (MakeRoom(known_.shapes, op.id(), op.upsert()->expire_time_ms, kShapesPerRobotMax, drop)) {
      return std::nullopt;
    }
    return TooManyShapes();
  }
  std::optional<Rejection> operator()(const model::ObjectOp& op) {
    if (op.upsert() == nullptr) return Remove(known_.objects, op.id());
    const auto drop = [this](std::string_view id) { rows_.DropObject(record_.robot->ruri, id); };
    const std::int64_t expires_ms = ExpiryOf(*op.upsert(), record_.received_at, rules_);
    if (MakeRoom(known_.objects, op.id(), expires_ms, kObjectsPerRobotMax, drop)) {
      return std::nullopt;
    }
    return TooManyObjects();
  }
  template <typename Unbounded>
  std::optional<Rejection> operator()(const Unbounded& /*body*/) {
    return std::nullopt;
  }

 private:
  std::optional<Rejection> Remove(KnownPresent& present, const std::string& id) {
    const std::string& ruri = record_.robot->ruri;
    present.counts[ruri] -= present.expires_ms.erase({ruri, id});
    return std::nullopt;
  }

  /// True if an upsert of the id may be written; it counts then.
  template <typename Drop>
  bool MakeRoom(KnownPresent& present, const std::string& id, std::int64_t expires_ms,
                std::size_t rows_max, const Drop& drop) {
    const std::string& ruri = record_.robot->ruri;
    const std::int64_t now_ms = UnixMs(record_.received_at);
    std::size_t& count = present.counts[ruri];
    const auto there = present.expires_ms.find({ruri, id});
    if (there != present.expires_ms.end()) {
      if (!IsExpired(there->second, now_ms)) {
        there->second = expires_ms;
        return true;
      }
      // A new beginning; the rows of the batch see to it that the old one goes.
      present.expires_ms.erase(there);
      --count;
    }
    if (count >= rows_max) {
      auto one = present.expires_ms.lower_bound({ruri, std::string()});
      while (one != present.expires_ms.end() && one->first.first == ruri) {
        if (!IsExpired(one->second, now_ms)) {
          ++one;
          continue;
        }
        // The view must outlive the batch's rows; the record does not name this id.
        drop(known_.Keep(one->first.second));
        one = present.expires_ms.erase(one);
        --count;
      }
    }
    if (count >= rows_max) return false;
    present.expires_ms[{ruri, id}] = expires_ms;
    ++count;
    return true;
  }

  const CommitRecord& record_;
  Known& known_;
  const StoreRules& rules_;
  BatchRows& rows_;
};

Outcome DecideRecord(const CommitRecord& record, std::size_t place, Known& known,
                     const StoreRules& rules, const std::optional<DatabaseRefusal>& refusal,
                     BatchRows& rows) {
  UPLINK_CHECK(record.seq <= model::kSeqMax, "a number past the contract's reached the store");
  if (record.held_since < known.held_since[record.robot->ruri]) {
    return {OutcomeKind::kFenced, std::nullopt};
  }
  model::Seq& cursor = known.sessions[{record.robot->ruri, record.session}].cursor;
  if (record.seq <= cursor) {
    const auto why = known.Quarantined(record, place);
    if (!why) return {OutcomeKind::kDuplicate, std::nullopt};
    return {OutcomeKind::kRefused, why};
  }
  cursor = record.seq;
  const auto place_number = static_cast<std::int32_t>(place);
  if (const auto* item = std::get_if<QuarantineItem>(&record.content)) {
    const QuarantineDetail detail = refusal ? refusal->detail : QuarantineDetail::kAll;
    rows.Reject(record, item->rejection, detail, place_number);
    known.NoteQuarantined(record, item->rejection);
    return {};
  }
  std::optional<Rejection> why;
  if (refusal) {
    why = refusal->rejection;
  } else {
    why = std::visit(Bounds(record, known, rules, rows),
                     std::get<model::Record>(record.content).body());
  }
  if (!why) {
    rows.Write(record, place_number);
    return {};
  }
  rows.Reject(record, *why, refusal ? refusal->detail : QuarantineDetail::kAll, place_number);
  known.NoteQuarantined(record, *why);
  return {OutcomeKind::kRefused, std::move(why)};
}

void DecideRest(const Part& part, Known& known, BatchRows& rows) {
  const Batch& batch = *part.batch;
  std::size_t place = batch.records.size();
  for (const GapItem& gap : batch.gaps) {
    if (gap.held_since >= known.held_since[gap.robot->ruri]) {
      rows.AddGap(gap, static_cast<std::int32_t>(place));
    }
    ++place;
  }
  if (batch.presence.empty()) return;
  model::Seq& cursor = known.sessions[{std::string(kServerRuri), batch.presence_session}].cursor;
  for (const PresenceItem& item : batch.presence) {
    if (item.number > cursor) {
      rows.AddPresence(item, batch.presence_session, static_cast<std::int32_t>(place));
      cursor = item.number;
    }
    ++place;
  }
}

}  // namespace

std::vector<Outcome> Decide(const Part& part, Known& known, const StoreRules& rules,
                            const std::optional<DatabaseRefusal>& refusal, BatchRows& rows) {
  UPLINK_CHECK(!refusal || part.last - part.first == 1, "a refusal is of one record");
  std::vector<Outcome> outcomes;
  outcomes.reserve(part.last - part.first);
  for (std::size_t place = part.first; place < part.last; ++place) {
    outcomes.push_back(
        DecideRecord(part.batch->records[place], place, known, rules, refusal, rows));
  }
  if (part.with_rest) DecideRest(part, known, rows);
  return outcomes;
}

}  // namespace uplink::storage::postgres
