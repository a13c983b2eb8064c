#include "server/session/end_status.h"

#include <fmt/format.h>

#include "server/session/limits.h"

namespace uplink::session {

absl::Status Drained() { return absl::UnavailableError("the server drains"); }

absl::Status NotSettled() {
  return absl::UnavailableError("not all was settled within drain.timeout");
}

absl::Status FrameTooLarge(std::uint64_t frame, std::uint64_t bytes, std::uint64_t bytes_max) {
  return absl::ResourceExhaustedError(fmt::format(
      "frame {}: {} bytes, the limit is {} (limits.frame_bytes_max)", frame, bytes, bytes_max));
}

absl::Status ReadNothing(std::size_t frames) {
  return absl::ResourceExhaustedError(
      fmt::format("the agent read nothing for {} s while {} frames waited for it",
                  kPeerStallMax.count(), frames));
}

transport::EndCause CauseOfRefusal(const absl::Status& status) {
  return absl::IsPermissionDenied(status) ? transport::EndCause::kNotAllowed
                                          : transport::EndCause::kBound;
}

}  // namespace uplink::session
