#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "server/identity/revocation_list.h"
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

/// What the server shows to robots. A value.
struct ServerCertificate {
  NamedFile file;
  ChainFacts facts;
  /// listen.relay is no loopback address.
  bool serves_others = false;
};
/// Whether robots can verify the server: the chain's dates, its authority and its names. A pure
/// function, as those below.
[[nodiscard]] Findings ServerCertificateFindings(const ServerCertificate& certificate,
                                                 SystemTime now);

/// The dates of authorities: one that has expired shuts out its robots.
[[nodiscard]] Findings AuthorityFindings(const NamedFile& file,
                                         const std::vector<CertificateFacts>& authorities,
                                         SystemTime now);

/// Lists of revoked certificates (CRL) whose authority promised the next one by now.
[[nodiscard]] Findings ListFindings(const NamedFile& file,
                                    const std::vector<identity::RevocationList>& lists,
                                    SystemTime now);

/// The dates of the certificate that is shown to a broker, or to callers of listen.http.
[[nodiscard]] Findings ShownCertificateFindings(const NamedFile& file,
                                                const std::vector<CertificateFacts>& chain,
                                                SystemTime now);

}  // namespace uplink::ctl
