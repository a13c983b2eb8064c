#pragma once

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/health/monitor.h"
#include "server/log/logger.h"

namespace uplink::health {

/// Tells readiness and the log of the relay's certificate files, each change once. Confined to one
/// thread.
class CertificateWatch final {
 public:
  /// Both outlive it.
  CertificateWatch(Monitor& monitor, const log::Logger& logger)
      : monitor_(monitor), logger_(logger) {}

  /// The files were looked at: `expiry` is that of the certificate that is served, `fit` says why
  /// the files on disk are not.
  void OnLook(SystemTime expiry, const absl::Status& fit);

 private:
  Monitor& monitor_;
  const log::Logger& logger_;
};

}  // namespace uplink::health
