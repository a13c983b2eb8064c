#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "storage/postgres/tables/table.h"
#include "storage/types.h"

namespace uplink::storage::postgres {

/// A row that a report of a robot makes. `place` is its place in the batch, from which its entry
/// comes. The pointers lead into the batch.
template <typename Body>
struct Report {
  const CommitRecord* record = nullptr;
  const Body* body = nullptr;
  std::int32_t place = 0;
};

/// What a column `entry` makes of a place. The transaction's number is read once per statement.
inline constexpr std::string_view kEntryOfPlace =
    "(SELECT currval('uplinkd.batches') << 20) + entry";

/// Where a list shows the session.
template <typename Out>
constexpr std::optional<Read<Out>> SessionReader() {
  if constexpr (requires(Out & row) { row.session; }) {
    return [](const Cell& cell, Out& row) { row.session = cell.Uuid(); };
  } else {
    return std::nullopt;
  }
}

/// Where a list shows the number.
template <typename Out>
constexpr std::optional<Read<Out>> SeqReader() {
  if constexpr (requires(Out & row) { row.seq; }) {
    return [](const Cell& cell, Out& row) { row.seq = static_cast<model::Seq>(cell.Int()); };
  } else {
    return std::nullopt;
  }
}

/// The columns with which every history of robots' messages begins. In: has `record` and `place`.
template <typename In, typename Out>
inline constexpr std::array<Column<In, Out>, 6> kReportColumns = {{
    {"ruri", Type::kText, Role::kValue,
     [](Array& to, const In& row) { to.Text(row.record->robot->ruri); }},
    {"received_at", Type::kTime, Role::kValue,
     [](Array& to, const In& row) { to.Time(row.record->received_at); }},
    {"entry", Type::kInt4, Role::kValue, [](Array& to, const In& row) { to.Int4(row.place); },
     std::nullopt, kEntryOfPlace},
    {"fleet", Type::kText, Role::kValue,
     [](Array& to, const In& row) { to.Text(row.record->robot->fleet); }},
    {"session", Type::kUuid, Role::kValue,
     [](Array& to, const In& row) { to.Uuid(row.record->session); }, SessionReader<Out>()},
    {"seq", Type::kInt8, Role::kValue, [](Array& to, const In& row) { to.Int8(row.record->seq); },
     SeqReader<Out>()},
}};

/// Lists of histories stand by the arrival.
template <typename Out>
constexpr Listed<Out> ByArrival() {
  return {"received_at", [](SystemTime time, Out& row) { row.received_at = time; }};
}

}  // namespace uplink::storage::postgres
