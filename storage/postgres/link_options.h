#pragma once

#include <absl/status/statusor.h>

#include "storage/postgres/link/link.h"
#include "storage/postgres/reader.h"
#include "storage/postgres/store.h"

namespace uplink::storage::postgres {

/// How a store's writer connects, and what else writes beside it.
///
/// Errors: kInvalidArgument for the URL.
[[nodiscard]] absl::StatusOr<Link::Options> LinkOptionsOf(const StoreOptions& options);

/// How a reader connects. Errors: as above.
[[nodiscard]] absl::StatusOr<Link::Options> LinkOptionsOf(const ReaderOptions& options);

}  // namespace uplink::storage::postgres
