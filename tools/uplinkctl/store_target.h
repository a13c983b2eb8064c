#pragma once

#include <string>
#include <variant>

#include <absl/status/statusor.h>

#include "storage/postgres/store.h"

namespace uplink::ctl {

/// The store that a command works on, beside its servers: the path of an SQLite file, or how to
/// reach a PostgreSQL database. A value.
using StoreTarget = std::variant<std::string, storage::postgres::StoreOptions>;

/// Errors: kInvalidArgument for a URL of no store.
[[nodiscard]] absl::StatusOr<StoreTarget> TargetOf(const std::string& url,
                                                   const std::string& password_file);

}  // namespace uplink::ctl
