#pragma once

#include "metrics/cells.h"
#include "server/log/logger.h"

namespace uplink::relay {

/// While it lives, gRPC's own lines (failed handshakes, trouble with a listener) go to the server's
/// log as `grpc` with their text, instead of to standard error in a form of their own. Any peer can
/// cause them, so their number is bounded as by log::RateLimited.
///
/// One at a time in a process: gRPC knows one receiver. Made before gRPC is used. Lines after its
/// end are lost; gRPC may still write them while it shuts down.
/// Thread: main's; gRPC writes from any thread.
class GrpcLog final {
 public:
  explicit GrpcLog(const log::Logger& logger);
  ~GrpcLog();
  GrpcLog(const GrpcLog&) = delete;
  GrpcLog& operator=(const GrpcLog&) = delete;

  /// TLS handshakes that failed, by gRPC's own lines: it has no other sign of them.
  [[nodiscard]] const metrics::Cell& handshakes_failed() const { return handshakes_failed_; }

 private:
  metrics::Cell handshakes_failed_;
};

}  // namespace uplink::relay
