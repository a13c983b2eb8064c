#include "storage/postgres/write/rejection_row.h"

#include <string>

#include "storage/numbers.h"

namespace uplink::storage::postgres {

model::Rejection ReadRejection(const Result& rows, int row, int column) {
  return {ReasonOf(rows.Int(row, column)), std::string(rows.Bytes(row, column + 1)),
          std::string(rows.Bytes(row, column + 2))};
}

}  // namespace uplink::storage::postgres
