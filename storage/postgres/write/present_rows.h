#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "storage/expiry.h"
#include "storage/postgres/link/connection.h"
#include "storage/postgres/tables/insert.h"
#include "storage/postgres/tables/present_sql.h"
#include "storage/present.h"
#include "storage/tables/present.h"

namespace uplink::storage::postgres {

/// What a batch does to the entries of one kind that is present: each key is written once, whatever
/// the batch reported of it, in order of the keys. The views and pointers lead into the batch.
template <typename Body>
class PresentRows final {
 public:
  /// `rules` outlives this.
  PresentRows(PresentKind kind, const StoreRules& rules) : kind_(kind), rules_(rules) {}

  void Upsert(const CommitRecord& record, const Body& body, const PresentChange& change,
              std::int32_t place) {
    State& state = states_[{change.key.ruri, change.key.id, change.key.source}];
    Upserted<Body>& upserted = state.upserted;
    const std::int64_t now_ms =
        BoundOf(kind_).expires ? ExpiredByMs(record.received_at, rules_) : 0;
    if (upserted.record != nullptr && IsExpired(upserted.expires_ms, now_ms)) {
      state.goes_if_expired_ms = kAlways;
      upserted.record = nullptr;
    }
    if (upserted.record == nullptr) {
      state.goes_if_expired_ms = std::max(state.goes_if_expired_ms, now_ms);
      upserted.first_at = record.received_at;
      upserted.entry = place;
    }
    upserted.record = &record;
    upserted.body = &body;
    upserted.expires_ms = change.expires_ms;
  }

  /// The views must live as long as the batch.
  void Delete(const PresentKey& key) {
    State& state = states_[{key.ruri, key.id, key.source}];
    state.goes_if_expired_ms = kAlways;
    state.upserted.record = nullptr;
  }

  /// `kTable` is the one of the kind.
  template <const auto& kTable>
  void MoveInto(std::vector<StoreCall>& calls) const {
    MoveRemovals(calls);
    std::vector<Upserted<Body>> rows;
    for (const auto& [key, state] : states_) {
      if (state.upserted.record != nullptr) rows.push_back(state.upserted);
    }
    AddInsert<kTable>(rows, calls);
  }

 private:
  /// The row that is there goes whenever it would expire; the statement's own number for it.
  static constexpr std::int64_t kAlways = std::numeric_limits<std::int64_t>::max();

  struct State {
    /// The row that is there goes if it expires by this time; kAlways: whenever.
    std::int64_t goes_if_expired_ms = 0;
    /// Without a record: the entry is not there at the end of the batch.
    Upserted<Body> upserted;
  };

  void MoveRemovals(std::vector<StoreCall>& calls) const {
    const bool expires = BoundOf(kind_).expires;
    const PresentSql& sql = PresentSqlOf(kind_);
    Array ruri{Type::kText}, id{Type::kText};
    Array source{Type::kText}, by_ms{Type::kInt8};
    for (const auto& [key, state] : states_) {
      if (!expires && state.goes_if_expired_ms != kAlways) continue;
      ruri.Text(std::get<0>(key));
      id.Text(std::get<1>(key));
      source.Text(std::get<2>(key));
      by_ms.Int8(state.goes_if_expired_ms);
    }
    if (ruri.size() == 0) return;
    StoreCall& call = calls.emplace_back(StoreCallOf(sql.remove.view(), &ruri, &id));
    if (sql.has_source) call.parameters.Add(&source);
    if (expires) call.parameters.Add(&by_ms);
  }

  const PresentKind kind_;
  const StoreRules& rules_;
  std::map<std::tuple<std::string_view, std::string_view, std::string_view>, State> states_;
};

}  // namespace uplink::storage::postgres
