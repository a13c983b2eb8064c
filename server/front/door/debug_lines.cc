#include "server/front/door/debug_lines.h"

namespace uplink::front {

void DebugLines::TellConnection(std::string_view event, std::uint64_t connection,
                                const Origin& origin, std::string_view why) const {
  logger_->Debug(event, {{"connection", connection},
                         {"peer", origin.text},
                         {"robot", origin.robot},
                         {"gateway", origin.gateway},
                         {"subject", origin.subject},
                         {"why", why}});
}

void DebugLines::TellStream(std::string_view event, std::int32_t stream, const Origin& origin,
                            std::string_view robot, std::string_view status) const {
  logger_->Debug(event, {{"stream", stream},
                         {"peer", origin.text},
                         {"robot", robot.empty() ? std::string_view(origin.robot) : robot},
                         {"gateway", origin.gateway},
                         {"status", status}});
}

}  // namespace uplink::front
