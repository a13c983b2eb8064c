#pragma once

#include <optional>
#include <span>
#include <vector>

#include "storage/outcome.h"
#include "storage/postgres/write/batch_rows.h"
#include "storage/postgres/write/known.h"
#include "storage/store_rules.h"

namespace uplink::storage::postgres {

/// What the database itself refused of a slice of one record.
struct DatabaseRefusal {
  model::Rejection rejection;
  QuarantineDetail detail = QuarantineDetail::kAll;
};

/// Decides a slice of a batch (storage/decide.h) by what is known: gathers into `rows` what to
/// write, and returns an outcome per record, then, with the rest, one per change of presence.
/// `known` follows the writes. With `refusal` the slice's one record goes to quarantine for it,
/// unless it is not written at all. `earlier` are the outcomes of the records before the slice.
[[nodiscard]] std::vector<Outcome> DecideSlice(const Slice& slice, KnownRows& known,
                                               const StoreRules& rules,
                                               const std::optional<DatabaseRefusal>& refusal,
                                               std::span<const Outcome> earlier, BatchRows& rows);

}  // namespace uplink::storage::postgres
