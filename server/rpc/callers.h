#pragma once

#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "server/http/guard.h"
#include "server/http/message.h"
#include "server/http/routes.h"
#include "server/http/site.h"
#include "server/identity/caller.h"
#include "server/transport/call_handler.h"

namespace uplink::rpc {

/// The route of HTTP that shows the same: its row of the table of rights counts for a call, too.
/// The path is one of http::Routes.
[[nodiscard]] http::RouteId RouteOf(std::string_view path);

/// Who calls, if it may ask for what the route shows. A known caller that may not is told to the
/// site, if there is one, for the audit.
///
/// Errors: kUnauthenticated, kPermissionDenied and kResourceExhausted, as HTTP says 401, 403 and
///         429. The guard has counted and logged them.
[[nodiscard]] absl::StatusOr<identity::Caller> CallerOf(http::Guard& guard, const http::Site* site,
                                                        http::RouteId route,
                                                        const transport::CallerProof& proof);

/// The error that an answer of HTTP tells; OK for an answer that holds what was asked for.
[[nodiscard]] absl::Status StatusOf(const http::Response& answer);

/// `192.0.2.7` of `192.0.2.7:4711`, `2001:db8::7` of `[2001:db8::7]:4711`.
[[nodiscard]] std::string WithoutPort(std::string_view address);

}  // namespace uplink::rpc
