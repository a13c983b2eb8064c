#pragma once

#include <cstddef>

#include "server/http/handlers.h"
#include "server/http/message.h"
#include "server/http/routes.h"

namespace uplink::http {

/// Answers below this go as they are: gzip would save less than a packet.
inline constexpr std::size_t kGzipBytesMin = 1024;

/// Gives an answer under /api the form that the request asks for: a list as lines, its tag alone
/// where the client has it already, and gzip. Pure; costs time by the answer's size, which
/// storage::kPageBytesMax bounds, so on the thread that made it.
[[nodiscard]] Response InFormOf(const RoutedRequest& request, const Route& route, Response answer);

}  // namespace uplink::http
