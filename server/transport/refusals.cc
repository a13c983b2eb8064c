#include "server/transport/refusals.h"

namespace uplink::transport {

void LogRefusal(log::RateLimited* lines, const std::string& peer, const std::string& robot,
                const absl::Status& status) {
  if (lines == nullptr) return;
  const bool protocol = absl::IsInvalidArgument(status);
  if (!protocol && !absl::IsUnauthenticated(status) && !absl::IsPermissionDenied(status) &&
      !absl::IsResourceExhausted(status)) {
    return;
  }
  lines->Write(log::Level::kWarn, protocol ? "protocol_error" : "stream_refused",
               {{"peer", peer}, {"robot", robot}, {"why", std::string(status.message())}});
}

}  // namespace uplink::transport
