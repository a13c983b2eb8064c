#include "server/rpc/fleet_methods.h"

#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include "schema/base/check.h"
#include "server/rpc/callers.h"
#include "server/rpc/health_calls.h"
#include "server/rpc/query_text.h"
#include "server/rpc/reflection_call.h"
#include "server/rpc/watch_call.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::rpc {
namespace {

using CallHandlerOr = absl::StatusOr<std::unique_ptr<transport::CallHandler>>;

/// What shows the descriptions of the contract by HTTP, and how the server does.
constexpr std::string_view kWatchPath = "/api/v1/watch";
constexpr std::string_view kContractPath = "/api/v1/openapi.yaml";

const google::protobuf::Message& PrototypeOf(std::string_view method) {
  const auto* service = v1::ListRobotsRequest::descriptor()->file()->FindServiceByName("FleetView");
  const auto* found = service->FindMethodByName(std::string(method));
  UPLINK_CHECK(found != nullptr, "the contract has each method of the table");
  return *google::protobuf::MessageFactory::generated_factory()->GetPrototype(found->input_type());
}

/// Reads a request and finds what answers it, for this caller.
Ask AskOf(const http::Site& site, http::RouteId route, const google::protobuf::Message& prototype,
          identity::Caller caller) {
  return [&site, route, &prototype,
          caller = std::move(caller)](std::string_view bytes) -> absl::StatusOr<Work> {
    const std::unique_ptr<google::protobuf::Message> request(prototype.New());
    if (!request->ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
      return absl::InvalidArgumentError(
          fmt::format("the request is no {}", prototype.GetTypeName()));
    }
    http::Resolved resolved = site.Resolve(
        route, {.query = QueryOf(*request), .form = view::Form::kWire, .caller = caller});
    return Work{resolved.lane, [run = std::move(resolved.run)]() -> absl::StatusOr<std::string> {
                  http::Response answer = run();
                  if (absl::Status failed = StatusOf(answer); !failed.ok()) return failed;
                  return std::move(answer.body);
                }};
  };
}

transport::Method ViewMethodOf(const RpcContext& context, const ViewMethod& row,
                               const Clock& clock) {
  const http::RouteId route = RouteOf(row.path);
  return {.open = true,
          .admission = transport::Admission::kCall,
          .serve = [context, route, &prototype = PrototypeOf(row.name),
                    &clock](transport::ServedCall& call) -> CallHandlerOr {
            auto caller = CallerOf(context.guard, route, call.proof());
            if (!caller.ok()) return caller.status();
            return UnaryCall::Make(context.calls, call, clock,
                                   AskOf(context.site, route, prototype, *std::move(caller)));
          }};
}

transport::Method WatchOf(const RpcContext& context, const Clock& clock) {
  const http::RouteId route = RouteOf(kWatchPath);
  return {.kind = transport::MethodKind::kServerStream,
          .open = true,
          .serve = [context, route, &clock](transport::ServedCall& call) -> CallHandlerOr {
            auto caller = CallerOf(context.guard, route, call.proof());
            if (!caller.ok()) return caller.status();
            return std::make_unique<WatchCall>(
                WatchCall::Context{context.watches, context.calls.post, clock}, call,
                *std::move(caller));
          }};
}

transport::Method ReflectionOf(const RpcContext& context) {
  const http::RouteId route = RouteOf(kContractPath);
  return {.kind = transport::MethodKind::kBidirectional,
          .open = true,
          .serve = [context, route](transport::ServedCall& call) -> CallHandlerOr {
            const auto caller = CallerOf(context.guard, route, call.proof());
            if (!caller.ok()) return caller.status();
            return std::make_unique<ReflectionCall>(call);
          }};
}

}  // namespace

transport::MethodsMaker FleetMethods(const RpcContext& context) {
  return [context](const Clock& clock) {
    transport::Methods methods = HealthMethods(context.monitor, context.calls, clock);
    for (const ViewMethod& row : kViewMethods) {
      methods.emplace(fmt::format("/uplink.v1.FleetView/{}", row.name),
                      ViewMethodOf(context, row, clock));
    }
    methods.emplace("/uplink.v1.FleetView/WatchRobots", WatchOf(context, clock));
    for (const std::string_view package : kReflectionPackages) {
      methods.emplace(fmt::format("/{}.ServerReflection/ServerReflectionInfo", package),
                      ReflectionOf(context));
    }
    return methods;
  };
}

}  // namespace uplink::rpc
