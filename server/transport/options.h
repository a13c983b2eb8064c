#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include "schema/base/clock.h"
#include "schema/limits.h"
#include "server/config/address.h"
#include "server/config/config.h"
#include "server/config/tls_groups.h"
#include "server/identity/authority_rules.h"

namespace uplink::transport {

/// PEM files. New handshakes use replaced files within kFilesRefresh; replace them by rename.
struct PemFiles {
  std::string certificate;
  std::string key;
  /// Empty: the folder alone says whom we trust.
  std::string client_ca;
  /// A folder of authorities (config::ReadAuthorityFolder); empty: none.
  std::string authorities = {};
  /// The folder's authorities are not trusted for standing there; what its entries say of those in
  /// client_ca counts all the same.
  bool entries_alone = false;
};

/// The same as text, for tests; never changes.
struct PemTexts {
  std::string certificate;
  std::string key;
  std::string client_ca;
  /// What the authorities may vouch for.
  identity::AuthorityRules rules = {};
};

/// The rules for what a handshake may agree on.
struct TlsRules {
  /// tls.min_version.
  config::TlsVersion minimum = config::TlsConfig().min_version;
  /// As config::ServedGroups.
  std::string groups = config::ServedGroups(config::TlsConfig());
  /// Peers must show a certificate. False: one that they show must be good.
  bool certificate_required = true;
};

using KeyMaterial = std::variant<PemFiles, PemTexts>;

/// How often the files are checked.
inline constexpr std::chrono::seconds kFilesRefresh{5};

/// Streams that are admitted per robot: every robot can reconnect before its old stream has ended.
inline constexpr std::size_t kStreamsPerRobot = 2;

/// Descriptors that are not for peers: those of HTTP's connections, and 128 for the store, files,
/// pipes and what the libraries open (measured: under 60 with PostgreSQL and two writers).
[[nodiscard]] constexpr std::size_t DescriptorsReserved(std::size_t http_connections_max) {
  return 128 + http_connections_max;
}

struct RelayOptions {
  config::ListenAddress address;
  KeyMaterial key_material;
  /// Threads, each with its own streams; 0: one per core.
  std::size_t queues = config::ListenConfig().relay_threads;
  TlsRules tls;
  /// listen.proxy_protocol_from.
  std::vector<config::Network> proxy_protocol_from;
  /// Descriptors that the rest of the server needs.
  std::size_t descriptors_reserved = DescriptorsReserved(config::HttpConfig().connections_max);
  /// Streams held at once.
  std::size_t streams_max = kStreamsPerRobot * config::LimitsConfig().robots_max;
  /// limits.gateway_streams_max.
  std::size_t gateway_streams_max = config::LimitsConfig().gateway_streams_max;
  /// limits.connection_age_max; zero: never.
  milliseconds connection_age_max = config::LimitsConfig().connection_age_max;
  /// What its threads are called.
  std::string name = "relay";
  /// Robots' streams are served; false: other methods alone.
  bool serves_relay = true;
  /// Descriptors that its connections may have; 0: what the process may have, less those of others.
  std::size_t descriptors_max = 0;
  /// Memory that the transport may use; 0: no bound. A quarter is for incomplete frames.
  std::size_t memory_bytes_max = 0;
};

}  // namespace uplink::transport
