#pragma once

#include <cstdint>
#include <string>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/health/monitor.h"
#include "server/identity/served_pems.h"
#include "server/log/logger.h"

namespace uplink::health {

/// Reports the relay's certificate files to readiness and the log: what is served, why the files on
/// disk are not, and that the certificate expires. Each change once. Confined to one thread.
class CertificateWatch final {
 public:
  /// Both outlive it. The logger's clock says what has expired.
  CertificateWatch(Monitor& monitor, const log::Logger& logger)
      : monitor_(monitor), logger_(logger) {}

  /// The files were read again: handshakes use `served`; `fit` is the reason why they do not use
  /// the files on disk, or OK.
  void OnLook(const identity::ServedPems& served, const absl::Status& fit);

 private:
  enum class Expiry : std::uint8_t { kFar, kNear, kOver };

  void TellFit(SystemTime expiry, const absl::Status& fit);
  void TellServed(const identity::ServedPems& served);
  void TellExpiry(SystemTime expiry);

  Monitor& monitor_;
  const log::Logger& logger_;
  identity::ServedPems served_;
  /// Why the files did not fit at the last look.
  std::string why_;
  Expiry told_ = Expiry::kFar;
};

}  // namespace uplink::health
