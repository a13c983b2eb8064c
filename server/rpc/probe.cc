#include "server/rpc/probe.h"

namespace uplink::rpc {
namespace {

void AddCalls(std::string_view method, const CallCounts& counts, metrics::Exposition& page) {
  for (std::size_t outcome = 0; outcome < counts.size(); ++outcome) {
    page.Add(metrics::MetricId::kFleetRpcCalls, counts[outcome],
             {method, kCallOutcomeTexts[outcome]});
  }
}

}  // namespace

CallOutcome OutcomeOf(std::optional<absl::StatusCode> code) {
  if (!code) return CallOutcome::kBroken;
  switch (*code) {
    case absl::StatusCode::kOk:
      return CallOutcome::kOk;
    case absl::StatusCode::kUnauthenticated:
    case absl::StatusCode::kPermissionDenied:
      return CallOutcome::kDenied;
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kNotFound:
    case absl::StatusCode::kAlreadyExists:
    case absl::StatusCode::kFailedPrecondition:
    case absl::StatusCode::kOutOfRange:
    case absl::StatusCode::kUnimplemented:
      return CallOutcome::kWrong;
    case absl::StatusCode::kCancelled:
      return CallOutcome::kBroken;
    default:  // a foreign list, which may grow
      return CallOutcome::kFailed;
  }
}

std::function<void(std::optional<absl::StatusCode>)> CountedIn(CallCounts& counts) {
  return [&counts](std::optional<absl::StatusCode> code) {
    counts[static_cast<std::size_t>(OutcomeOf(code))].Add();
  };
}

void AddSamples(const RpcProbe& probe, metrics::Exposition& page) {
  using enum metrics::MetricId;
  for (std::size_t i = 0; i < kViewMethods.size(); ++i) {
    AddCalls(kViewMethods[i].name, probe.view[i], page);
  }
  for (std::size_t i = 0; i < kAdminMethods.size(); ++i) {
    AddCalls(kAdminMethods[i].name, probe.admin[i], page);
  }
  for (std::size_t i = 0; i < kOtherMethodNames.size(); ++i) {
    AddCalls(kOtherMethodNames[i], probe.other[i], page);
  }
  page.Add(kFleetRpcConnections, probe.listener.connections);
  page.Add(kFleetRpcConnectionsLimit, probe.listener.connections_limit);
  for (std::size_t cause = 0; cause < transport::kTurnedAwayTexts.size(); ++cause) {
    page.Add(kFleetRpcTurnedAway, probe.listener.turned_away_total[cause],
             {transport::kTurnedAwayTexts[cause]});
  }
}

}  // namespace uplink::rpc
