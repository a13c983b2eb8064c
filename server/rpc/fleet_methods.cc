#include "server/rpc/fleet_methods.h"

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/util/json_util.h>

#include "schema/base/check.h"
#include "server/http/watch_events.h"
#include "server/rpc/callers.h"
#include "server/rpc/health_calls.h"
#include "server/rpc/query_text.h"
#include "server/rpc/reflection_call.h"
#include "server/rpc/watch_call.h"
#include "uplink/v1/admin.pb.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::rpc {
namespace {

using CallHandlerOr = absl::StatusOr<std::unique_ptr<transport::CallHandler>>;

/// Paths of HTTP whose rights count for methods that no path answers: WatchRobots, and reflection,
/// which shows the contract as this path does.
constexpr std::string_view kWatchPath = "/api/v1/watch";
constexpr std::string_view kContractPath = "/api/v1/openapi.yaml";

const google::protobuf::Message& PrototypeOf(const google::protobuf::ServiceDescriptor& service,
                                             std::string_view method) {
  const auto* found = service.FindMethodByName(std::string(method));
  UPLINK_CHECK(found != nullptr, "the contract has each method of the table");
  return *google::protobuf::MessageFactory::generated_factory()->GetPrototype(found->input_type());
}

/// The request as the route takes it: as its query, or, where it changes something, as its body.
absl::StatusOr<http::RoutedRequest> RoutedOf(http::RouteId route,
                                             const google::protobuf::Message& request) {
  http::RoutedRequest routed{.form = view::Form::kWire};
  if (http::Routes()[route.index].action.empty()) {
    routed.query = QueryOf(request);
    return routed;
  }
  const auto printed = google::protobuf::util::MessageToJsonString(request, &routed.body);
  if (!printed.ok()) return absl::InvalidArgumentError(std::string(printed.message()));
  routed.content_type = http::kJson;
  return routed;
}

/// Who makes the call, if it may (CallerOf). Its connection learns who shows a token.
absl::StatusOr<identity::Caller> JudgedCallerOf(const RpcContext& context, const http::Site* site,
                                                http::RouteId route, transport::ServedCall& call) {
  auto caller = CallerOf(context.guard, site, route, call.proof());
  if (caller.ok() && caller->proof == identity::Proof::kToken) call.NoteCaller(caller->name);
  return caller;
}

/// Reads a request and finds what answers it, for its caller as that is judged then: the request
/// may come kRequestWait after its call.
Ask AskOf(const RpcContext& context, http::RouteId route,
          const google::protobuf::Message& prototype, transport::CallerProof proof) {
  return [context, route, &prototype,
          proof = std::move(proof)](std::string_view bytes) -> absl::StatusOr<Work> {
    auto caller = CallerOf(context.guard, &context.site, route, proof);
    if (!caller.ok()) return caller.status();
    const std::unique_ptr<google::protobuf::Message> request(prototype.New());
    if (!request->ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
      return absl::InvalidArgumentError(
          fmt::format("the request is no {}", prototype.GetTypeName()));
    }
    absl::StatusOr<http::RoutedRequest> routed = RoutedOf(route, *request);
    if (!routed.ok()) return routed.status();
    routed->caller = *std::move(caller);
    routed->from = WithoutPort(proof.from);
    http::Resolved resolved = context.site.Resolve(route, *std::move(routed));
    return Work{resolved.lane, [run = std::move(resolved.run)]() -> absl::StatusOr<std::string> {
                  http::Response answer = run();
                  if (absl::Status failed = StatusOf(answer); !failed.ok()) return failed;
                  return std::move(answer.body);
                }};
  };
}

transport::Method MethodOf(const RpcContext& context, std::string_view path,
                           const google::protobuf::Message& prototype, CallCounts& counts,
                           const Clock& clock) {
  return {.open = true,
          .admission = transport::Admission::kCall,
          .serve = [context, route = RouteOf(path), &prototype,
                    &clock](transport::ServedCall& call) -> CallHandlerOr {
            const auto caller = JudgedCallerOf(context, &context.site, route, call);
            if (!caller.ok()) return caller.status();
            return UnaryCall::Make(context.calls, call, clock, http::WatcherOf(*caller),
                                   AskOf(context, route, prototype, call.proof()));
          },
          .ended = CountedIn(counts)};
}

transport::Method WatchOf(const RpcContext& context, const Clock& clock) {
  const http::RouteId route = RouteOf(kWatchPath);
  return {
      .kind = transport::MethodKind::kServerStream,
      .open = true,
      .serve = [context, route, &clock](transport::ServedCall& call) -> CallHandlerOr {
        auto caller = JudgedCallerOf(context, &context.site, route, call);
        if (!caller.ok()) return caller.status();
        auto may_go_on = [context, route, proof = call.proof()] {
          return CallerOf(context.guard, &context.site, route, proof).ok();
        };
        return std::make_unique<WatchCall>(
            WatchCall::Context{context.watches, context.calls.post, clock, std::move(may_go_on)},
            call, *std::move(caller));
      },
      .ended = CountedIn(context.probe.Of(OtherMethod::kWatchRobots))};
}

template <std::size_t kCount>
void AddMethods(const RpcContext& context, const google::protobuf::FileDescriptor& file,
                std::string_view service, const std::array<PathMethod, kCount>& rows,
                std::array<CallCounts, kCount>& counts, const Clock& clock,
                transport::Methods& methods) {
  const auto* described = file.FindServiceByName(std::string(service));
  UPLINK_CHECK(described != nullptr, "the contract has the service");
  for (std::size_t i = 0; i < kCount; ++i) {
    const PathMethod& row = rows[i];
    methods.emplace(
        fmt::format("/{}/{}", described->full_name(), row.name),
        MethodOf(context, row.path, PrototypeOf(*described, row.name), counts[i], clock));
  }
}

transport::Method ReflectionOf(const RpcContext& context) {
  const http::RouteId route = RouteOf(kContractPath);
  return {.kind = transport::MethodKind::kBidirectional,
          .open = true,
          .serve = [context, route](transport::ServedCall& call) -> CallHandlerOr {
            const auto caller = JudgedCallerOf(context, nullptr, route, call);
            if (!caller.ok()) return caller.status();
            return std::make_unique<ReflectionCall>(call);
          },
          .ended = CountedIn(context.probe.Of(OtherMethod::kReflection))};
}

}  // namespace

transport::MethodsMaker FleetMethods(const RpcContext& context) {
  return [context](const Clock& clock) {
    transport::Methods methods = HealthMethods(context.monitor, context.probe, clock);
    AddMethods(context, *v1::ListRobotsRequest::descriptor()->file(), "FleetView", kViewMethods,
               context.probe.view, clock, methods);
    AddMethods(context, *v1::ReloadRequest::descriptor()->file(), "FleetAdmin", kAdminMethods,
               context.probe.admin, clock, methods);
    methods.emplace("/uplink.v1.FleetView/WatchRobots", WatchOf(context, clock));
    for (const std::string_view package : kReflectionPackages) {
      methods.emplace(fmt::format("/{}.ServerReflection/ServerReflectionInfo", package),
                      ReflectionOf(context));
    }
    return methods;
  };
}

}  // namespace uplink::rpc
