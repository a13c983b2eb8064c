#include "server/uncrew/avatar_methods.h"

#include <memory>
#include <string_view>
#include <utility>

#include "schema/model/uncrew/types.h"
#include "server/uncrew/avatar_call.h"

namespace uplink::uncrew {
namespace {

using CallHandlerOr = absl::StatusOr<std::unique_ptr<transport::CallHandler>>;

std::string PathOf(std::string_view method) {
  return std::string("/uncrew.v1.AvatarService/").append(method);
}

transport::Method MethodOf(transport::MethodKind kind) {
  return {.kind = kind,
          .roles = {identity::Role::kRobot, identity::Role::kGateway},
          .audience = "drones call with the certificates of robots and gateways alone",
          .admission = transport::Admission::kCall,
          // A caller whose deadline is shorter than the store's answer sends the same sample again.
          .at_deadline = absl::UnavailableError(
              "the store did not confirm the sample in the caller's time: send it again")};
}

transport::Methods MethodsOf(const std::shared_ptr<AvatarThread>& thread) {
  transport::Methods methods;
  for (const model::uncrew::TypeRow& row : model::uncrew::kTypeRows) {
    transport::Method method = MethodOf(transport::MethodKind::kUnary);
    method.serve = [thread, type = row.type](transport::ServedCall& call) -> CallHandlerOr {
      return std::make_unique<AvatarCall>(*thread, call, type);
    };
    methods.emplace(PathOf(row.method), std::move(method));
  }
  transport::Method subscribe = MethodOf(transport::MethodKind::kServerStream);
  subscribe.serve = [](transport::ServedCall& /*call*/) -> CallHandlerOr {
    return absl::UnimplementedError("this server relays no commands");
  };
  methods.emplace(PathOf("SubscribeUAVCommands"), std::move(subscribe));
  return methods;
}

}  // namespace

transport::MethodsMaker AvatarMethods(AvatarContext context) {
  return [context = std::move(context)](const Clock& clock) {
    metrics::Ledger& ledger = context.ledgers.NewPage(model::MessageSource::kUncrew);
    return MethodsOf(std::make_shared<AvatarThread>(
        AvatarThread{.clock = clock,
                     .watch = context.watch,
                     .drones = context.drones,
                     .probe = context.probe,
                     .answer_within = context.answer_within,
                     .ruri_template = context.ruri_template,
                     .port = ingest::Port({.clock = clock,
                                           .fleet = context.fleet,
                                           .ledger = ledger,
                                           .allowances = context.allowances,
                                           .in_flight_max = context.in_flight_max,
                                           .payload_bytes_max = context.payload_bytes_max}),
                     .reports = context.reports}));
  };
}

}  // namespace uplink::uncrew
