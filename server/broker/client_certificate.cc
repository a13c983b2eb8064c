#include "server/broker/client_certificate.h"

#include "server/mqtt/secrets.h"

namespace uplink::broker {

void NoteCertificate(const mqtt::ClientSettings& settings, BrokerProbe& probe) {
  const auto expiry = mqtt::CertificateExpiry(settings);
  if (!expiry.ok()) return;
  probe.certificate_expiry_s.Set(*expiry ? UnixMs(**expiry) / 1'000 : 0);
}

}  // namespace uplink::broker
