#pragma once

#include <span>

#include "storage/migration.h"

namespace uplink::storage::sqlite {

/// All steps, from version 1, without a hole. Immutable.
[[nodiscard]] std::span<const Migration> Migrations();

}  // namespace uplink::storage::sqlite
