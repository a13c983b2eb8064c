#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "tools/uplinkctl/doctor/certificate_facts.h"
#include "tools/uplinkctl/doctor/finding.h"

namespace uplink::ctl {

/// A certificate that ends within this is worth a warning; the alerts of deploy/prometheus have the
/// same.
inline constexpr std::chrono::days kExpirySoon{14};

/// A file of the configuration.
struct NamedFile {
  /// `tls.certificate_file`.
  std::string key;
  std::string path;
};

/// Whether robots can verify the server: dates of the chain, where it leads, for which names it
/// is. `serves_others`: listen.relay is no loopback address. All here are pure functions.
struct ServerCertificate {
  NamedFile file;
  ChainFacts facts;
  bool serves_others = false;
};
[[nodiscard]] Findings ServerCertificateFindings(const ServerCertificate& certificate,
                                                 SystemTime now);

/// The dates of authorities: one that has expired shuts out its robots.
[[nodiscard]] Findings AuthorityFindings(const NamedFile& file,
                                         const std::vector<CertificateFacts>& authorities,
                                         SystemTime now);

/// The dates of the certificate that is shown to a broker.
[[nodiscard]] Findings ClientCertificateFindings(const NamedFile& file,
                                                 const std::vector<CertificateFacts>& chain,
                                                 SystemTime now);

}  // namespace uplink::ctl
