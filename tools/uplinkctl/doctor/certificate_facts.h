#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "server/identity/pem_file.h"

namespace uplink::ctl {

/// One certificate of a file. A value.
struct CertificateFacts {
  /// As one line (RFC 2253).
  std::string subject;
  SystemTime begin;
  SystemTime end;
};

/// Where the server's chain leads.
enum class Trust : std::uint8_t {
  /// To an authority of tls.client_ca_file.
  kOwnAuthority,
  /// To one that this machine's programs trust.
  kSystem,
  /// To one that is in neither: robots may have it all the same.
  kElsewhere,
  /// An authority of tls.client_ca_file has the issuer's name and another key.
  kOtherKey,
  /// A certificate of the file is not signed by the one behind it.
  kBroken,
};

/// What a server shows to robots. A value.
struct ChainFacts {
  /// Leaf first; at least one.
  std::vector<CertificateFacts> chain;
  Trust trust = Trust::kElsewhere;
  /// Who signed the last.
  std::string issuer;
  /// DNS names and IP addresses that the leaf is for.
  std::vector<std::string> names;
};

/// The certificates of a PEM text; empty if it cannot be read (config::ValidateFiles says why).
///
/// Thread: pure; any thread.
[[nodiscard]] std::vector<CertificateFacts> ReadFacts(const identity::NamedPem& pem);

/// The chain of a server, held against its authorities and those of the machine; nothing if it
/// cannot be read.
///
/// Thread: any; reads the machine's store of authorities.
[[nodiscard]] std::optional<ChainFacts> ReadChain(const identity::NamedPem& certificate,
                                                  const identity::NamedPem& authorities);

}  // namespace uplink::ctl
