#pragma once

#include <cstddef>
#include <string_view>

#include <absl/status/statusor.h>

#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

/// What a `SELECT COUNT(*)` with the robot as its one parameter gives.
[[nodiscard]] absl::StatusOr<std::size_t> CountOf(Statement& count, std::string_view ruri);

/// How many rows a deletion that returns each of them deleted.
[[nodiscard]] absl::StatusOr<std::size_t> CountReturned(Rows rows);

}  // namespace uplink::storage::sqlite
