#pragma once

#include <cstdint>
#include <string_view>

#include <absl/status/status.h>

#include "server/front/door/origin.h"
#include "server/log/logger.h"

namespace uplink::front {

/// Lines of level debug: one when a connection or stream begins, and one when it ends; none about
/// the server's own probe. A stream is named by its HTTP/2 number within the connection of `peer`.
/// While that level is off, a line costs a comparison.
///
/// Thread: thread-safe.
class DebugLines final {
 public:
  /// Null: no lines.
  explicit DebugLines(const log::Logger* logger) : logger_(logger) {}

  /// The handshake succeeded; `origin` says who the peer is.
  void ConnectionOpened(std::uint64_t connection, const Origin& origin) const {
    if (On() && !origin.own) TellConnection("connection_opened", connection, origin, {});
  }
  /// `why`: the cause, a word of ours.
  void HandshakeFailed(std::uint64_t connection, const Origin& origin, std::string_view why) const {
    if (On() && !origin.own) TellConnection("handshake_failed", connection, origin, why);
  }
  void ConnectionClosed(std::uint64_t connection, const Origin& origin) const {
    if (On() && !origin.own) TellConnection("connection_closed", connection, origin, {});
  }

  void StreamOpened(std::int32_t stream, const Origin& origin) const {
    if (On()) TellStream("stream_opened", stream, origin, {}, {});
  }
  /// `robot`: the robot that Hello named; empty: that of the certificate. `status`: what the robot
  /// is told.
  void StreamEnded(std::int32_t stream, const Origin& origin, std::string_view robot,
                   const absl::Status& status) const {
    if (On()) TellStream("stream_ended", stream, origin, robot, status.ToString());
  }
  /// It ended without a status to the robot.
  void StreamBroken(std::int32_t stream, const Origin& origin, std::string_view robot) const {
    if (On()) TellStream("stream_broken", stream, origin, robot, {});
  }

 private:
  [[nodiscard]] bool On() const {
    return logger_ != nullptr && logger_->Enabled(log::Level::kDebug);
  }
  void TellConnection(std::string_view event, std::uint64_t connection, const Origin& origin,
                      std::string_view why) const;
  void TellStream(std::string_view event, std::int32_t stream, const Origin& origin,
                  std::string_view robot, std::string_view status) const;

  const log::Logger* const logger_;
};

}  // namespace uplink::front
