#include "server/health/certificate_watch.h"

#include <string>

namespace uplink::health {

void CertificateWatch::OnLook(SystemTime expiry, const absl::Status& fit) {
  if (!monitor_.NoteCertificate(expiry, fit.ok())) return;
  if (fit.ok()) {
    logger_.Info("certificate_fits_again", {});
  } else {
    logger_.Error("certificate_mismatch", {{"why", std::string(fit.message())}});
  }
}

}  // namespace uplink::health
