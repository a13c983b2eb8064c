#pragma once

#include "schema/model/rejection.h"
#include "storage/postgres/result.h"

namespace uplink::storage::postgres {

/// The reason of the contract that a column holds; kStoreRefused for a number that none has, which
/// a newer program may have written: one row must not keep a robot, nor a batch, from the store.
[[nodiscard]] model::RejectReason ReasonOf(std::int64_t number);

/// The columns reason, field and detail, of which the first is `column`.
[[nodiscard]] model::Rejection ReadRejection(const Result& rows, int row, int column);

}  // namespace uplink::storage::postgres
