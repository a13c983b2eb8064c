#pragma once

#include "schema/base/clock.h"
#include "server/http/routes.h"
#include "server/http/server.h"

namespace uplink::http {

/// Counts an answer to a request that began at `started`; at level debug it is a line.
void NoteAnswered(const HttpServer::Context& server, RouteId route, int status, SteadyTime started);

}  // namespace uplink::http
