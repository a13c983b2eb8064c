#include "server/transport/refusals.h"

namespace uplink::transport {

std::string_view RefusalEvent(const absl::Status& status, std::string_view gateway) {
  if (absl::IsAborted(status) && !gateway.empty()) return "stream_superseded";
  if (absl::IsInvalidArgument(status)) return "protocol_error";
  const bool refused = absl::IsUnauthenticated(status) || absl::IsPermissionDenied(status) ||
                       absl::IsResourceExhausted(status);
  return refused ? "stream_refused" : "";
}

void LogRefusal(log::RateLimited* lines, const RefusedPeer& peer, const absl::Status& status) {
  const std::string_view event = RefusalEvent(status, peer.gateway);
  if (lines == nullptr || event.empty()) return;
  lines->Write(log::Level::kWarn, event,
               {{"peer", peer.peer},
                {"robot", peer.robot},
                {"gateway", peer.gateway},
                {"why", std::string(status.message())}});
}

}  // namespace uplink::transport
