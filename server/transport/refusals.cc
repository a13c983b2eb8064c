#include "server/transport/refusals.h"

namespace uplink::transport {

std::string_view RefusalEvent(const absl::Status& status) {
  if (absl::IsInvalidArgument(status)) return "protocol_error";
  const bool refused = absl::IsUnauthenticated(status) || absl::IsPermissionDenied(status) ||
                       absl::IsResourceExhausted(status);
  return refused ? "stream_refused" : "";
}

void LogRefusal(log::RateLimited* lines, const std::string& peer, const std::string& robot,
                const absl::Status& status) {
  const std::string_view event = RefusalEvent(status);
  if (lines == nullptr || event.empty()) return;
  lines->Write(log::Level::kWarn, event,
               {{"peer", peer}, {"robot", robot}, {"why", std::string(status.message())}});
}

}  // namespace uplink::transport
