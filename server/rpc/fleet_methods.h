#pragma once

#include "server/health/monitor.h"
#include "server/http/guard.h"
#include "server/http/site.h"
#include "server/rpc/path_methods.h"
#include "server/rpc/probe.h"
#include "server/rpc/unary_call.h"
#include "server/transport/methods.h"
#include "server/view/watches.h"

namespace uplink::rpc {

/// What the methods use. All of it outlives the listener.
struct RpcContext {
  const http::Site& site;
  http::Guard& guard;
  const health::Monitor& monitor;
  view::Watches& watches;
  UnaryCalls& calls;
  RpcProbe& probe;
};

/// The methods for operators, made for each thread: FleetView, FleetAdmin, and gRPC's own health
/// and reflection. Each call is judged by the guard and the row of the table of rights that counts
/// for the same question by HTTP; health is open to anyone, as the probes are.
[[nodiscard]] transport::MethodsMaker FleetMethods(const RpcContext& context);

}  // namespace uplink::rpc
