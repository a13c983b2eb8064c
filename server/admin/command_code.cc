#include "server/admin/command_code.h"

#include "server/admin/command_rate.h"

namespace uplink::admin {

std::optional<CommandCode> CommandCodeOf(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kInvalidArgument:
      return CommandCode{400, "INVALID_ARGUMENT"};
    case absl::StatusCode::kNotFound:
      return CommandCode{404, "NOT_FOUND"};
    case absl::StatusCode::kFailedPrecondition:
      return CommandCode{409, "FAILED_PRECONDITION"};
    case absl::StatusCode::kResourceExhausted:
      return CommandCode{RetryAfterOf(status) ? 429 : 409, "RESOURCE_EXHAUSTED"};
    default:  // a foreign enumeration
      return std::nullopt;
  }
}

}  // namespace uplink::admin
