#include "storage/postgres/write/limited_rows.h"

#include <cstdint>

namespace uplink::storage::postgres {
namespace {

// A row that is there is one of an evicted session that had the same id.
constexpr std::string_view kKeep =
    "INSERT INTO uplinkd.kept_rejects AS k (ruri, session, last, first, entry, reason, field,"
    " detail) SELECT u.ruri, u.session, u.last, u.first, (b.number << 20) + u.place, u.reason,"
    " u.field, u.detail FROM unnest($1::text[], $2::uuid[], $3::bigint[], $4::bigint[], $5::int[],"
    " $6::int[], $7::text[], $8::text[])"
    " AS u (ruri, session, last, first, place, reason, field, detail),"
    " (SELECT currval('uplinkd.batches')) AS b (number)"
    " ON CONFLICT (ruri, session, last) DO UPDATE SET first = excluded.first,"
    " entry = excluded.entry, reason = excluded.reason, field = excluded.field,"
    " detail = excluded.detail";

}  // namespace

void LimitedRows::MoveInto(std::vector<StoreCall>& calls) const {
  if (rows_.empty()) return;
  Array ruri{Type::kText}, session{Type::kUuid}, last{Type::kInt8}, first{Type::kInt8};
  Array place{Type::kInt4}, reason{Type::kInt4}, field{Type::kText}, detail{Type::kText};
  for (const Row& row : rows_) {
    ruri.Text(row.record->robot->ruri);
    session.Uuid(row.record->session);
    last.Int8(row.record->seq);
    first.Int8(row.range->first);
    place.Int4(row.place);
    reason.Int4(static_cast<std::int32_t>(row.range->rejection.reason));
    field.Text(row.range->rejection.field);
    detail.Text(row.range->rejection.detail);
  }
  calls.push_back(
      StoreCallOf(kKeep, {&ruri, &session, &last, &first, &place, &reason, &field, &detail}));
}

}  // namespace uplink::storage::postgres
