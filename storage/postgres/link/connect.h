#pragma once

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/postgres/link/connection.h"

// How a connection comes to be. For connection.cc.
namespace uplink::storage::postgres {

/// Waits for `events` of poll(2). Errors: kDeadlineExceeded.
[[nodiscard]] absl::Status AwaitSocket(int socket, short events, SteadyTime deadline,
                                       const Clock& clock);

/// A connected handle; the caller's to finish. Errors: as Connection::Open.
[[nodiscard]] absl::StatusOr<pg_conn*> Connect(const ConnectionOptions& options,
                                               const Clock& clock);

}  // namespace uplink::storage::postgres
