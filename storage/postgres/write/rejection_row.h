#pragma once

#include "schema/model/rejection.h"
#include "storage/postgres/link/result.h"

namespace uplink::storage::postgres {

/// The columns reason, field and detail, of which the first is `column`.
[[nodiscard]] model::Rejection ReadRejection(const Result& rows, int row, int column);

}  // namespace uplink::storage::postgres
