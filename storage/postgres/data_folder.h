#pragma once

#include <string>

#include <absl/status/statusor.h>

#include "storage/postgres/link/connection.h"

namespace uplink::storage::postgres {

/// The folder in which the server keeps our database: that of its tablespace, else the server's
/// data folder. Empty where this process cannot know it:
///
/// - the server was reached in another way than by a Unix socket, by us or by a pooler between, so
///   it may be on another machine;
/// - our role may not read the setting `data_directory` (pg_read_all_settings may);
/// - there is no folder of that name here that belongs to the user who runs the server: it has
///   another view of the files, as in a container.
///
/// Errors: of Connection::Run.
[[nodiscard]] absl::StatusOr<std::string> ReadDataFolder(Connection& connection);

}  // namespace uplink::storage::postgres
