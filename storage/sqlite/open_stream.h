#pragma once

#include <absl/status/statusor.h>

#include "storage/identity.h"
#include "storage/open_stream.h"

namespace uplink::storage::sqlite {

struct Tables;

/// Store::OpenStreams for one stream, within the caller's transaction.
///
/// Errors: those of errors.h. Thread: confined to the thread of its database.
[[nodiscard]] absl::StatusOr<OpenResult> OpenStream(Tables& tables, const OpenRequest& request,
                                                    const ProcessId& process);

}  // namespace uplink::storage::sqlite
