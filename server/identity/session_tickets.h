#pragma once

#include <string>
#include <string_view>

#include <absl/status/statusor.h>

namespace uplink::identity {

/// A configuration of OpenSSL with `NumTickets = 0` for every server of the process. All that
/// stands in `text` stays as it is, and so does a `NumTickets` that stands there already.
///
/// Errors: kFailedPrecondition if `text` is no configuration. Thread: any.
[[nodiscard]] absl::StatusOr<std::string> WithoutSessionTickets(std::string_view text);

/// Makes the process's TLS 1.3 servers send no session tickets. OpenSSL sends two a handshake and,
/// for each, reads back the client's certificate with its key: a fifth of what an accept costs, for
/// tickets that robots do not come back with. gRPC 1.51 has no setter; what it opens reads
/// OpenSSL's own configuration, which is read here in place of OpenSSL, from the same file.
///
/// Errors: kFailedPrecondition if that file is no configuration: nothing was changed.
/// Thread: main, before anything else of OpenSSL is used.
[[nodiscard]] absl::Status SendNoSessionTickets();

}  // namespace uplink::identity
