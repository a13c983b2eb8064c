#pragma once

#include <array>
#include <optional>

#include "schema/model/ids.h"
#include "storage/sqlite/entry_number.h"
#include "storage/sqlite/tables/table.h"
#include "storage/types.h"

namespace uplink::storage::sqlite {

/// A row that a report of a robot makes. The pointers lead into the batch.
template <typename Body>
struct Report {
  const CommitRecord* record = nullptr;
  const Body* body = nullptr;
  EntryNumber entry = 0;
};

/// Where a list shows the session.
template <typename Out>
constexpr std::optional<Read<Out>> SessionReader() {
  if constexpr (requires(Out & row) { row.session; }) {
    return [](const Cell& cell, Out& row) { row.session = cell.Session(); };
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

/// The columns with which every history of robots' messages begins. In: has `record` and `entry`.
template <typename In, typename Out>
inline constexpr std::array<Column<In, Out>, 6> kReportColumns = {{
    {"ruri", Role::kValue, [](Binder& to, const In& row) { to.Text(row.record->robot->ruri); }},
    {"received_at", Role::kValue,
     [](Binder& to, const In& row) { to.Time(row.record->received_at); }},
    {"entry", Role::kValue, [](Binder& to, const In& row) { to.Int(row.entry); }},
    {"fleet", Role::kValue, [](Binder& to, const In& row) { to.Text(row.record->robot->fleet); }},
    {"session", Role::kValue, [](Binder& to, const In& row) { to.Session(row.record->session); },
     SessionReader<Out>()},
    {"seq", Role::kValue, [](Binder& to, const In& row) { to.Int(row.record->seq); },
     SeqReader<Out>()},
}};

/// Lists of histories stand by the arrival.
template <typename Out>
constexpr Listed<Out> ByArrival() {
  return {"received_at", [](SystemTime time, Out& row) { row.received_at = time; }};
}

}  // namespace uplink::storage::sqlite
