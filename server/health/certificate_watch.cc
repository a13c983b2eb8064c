#include "server/health/certificate_watch.h"

#include <utility>

#include "server/health/readiness.h"
#include "server/identity/expiry.h"

namespace uplink::health {

void CertificateWatch::OnLook(const identity::ServedPems& served, const absl::Status& fit) {
  TellFit(served.expiry, fit);
  if (fit.ok()) TellServed(served);
  TellExpiry(served.expiry);
}

void CertificateWatch::TellFit(SystemTime expiry, const absl::Status& fit) {
  const bool changed = monitor_.NoteCertificate(expiry, fit.ok());
  // A new reason is logged too: after one file is corrected, the next may not fit either.
  const std::string before = std::exchange(why_, std::string(fit.message()));
  if (!changed && before == why_) return;
  if (fit.ok()) {
    logger_.Info("certificate_fits_again", {});
  } else {
    logger_.Error("certificate_mismatch", {{"why", why_}});
  }
}

void CertificateWatch::TellServed(const identity::ServedPems& served) {
  if (served == served_) return;
  served_ = served;
  logger_.Info("certificates_served", {{"expires", identity::ExpiryText(served.expiry)},
                                       {"authorities", served.authorities},
                                       {"certificate_sha256", served.certificate_sha256},
                                       {"client_ca_sha256", served.client_ca_sha256}});
}

void CertificateWatch::TellExpiry(SystemTime expiry) {
  const SystemTime now = logger_.clock().System();
  const Expiry found = expiry <= now                        ? Expiry::kOver
                       : expiry <= now + kCertificateNotice ? Expiry::kNear
                                                            : Expiry::kFar;
  if (std::exchange(told_, found) == found) return;
  if (found == Expiry::kNear) {
    logger_.Warn("certificate_expiring", {{"expires", identity::ExpiryText(expiry)}});
  } else if (found == Expiry::kOver) {
    logger_.Error("certificate_expired", {{"expires", identity::ExpiryText(expiry)}});
  }
}

}  // namespace uplink::health
