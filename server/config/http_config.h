#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <sys/types.h>

#include "server/config/networks.h"

namespace uplink::config {

/// Connections of listen.metrics held at once: room for some Prometheus servers with two jobs each
/// and the probes of a cluster.
inline constexpr std::size_t kMetricsConnectionsMax = 32;

struct HttpConfig {
  /// Names under which /api may be asked for, beside addresses and localhost; without a port.
  std::vector<std::string> hosts;
  /// Scrapes are shown under these names alone, too.
  bool hosts_cover_metrics = false;
  /// Connections held at once, those that are kept for probes and scrapes included.
  std::size_t connections_max = 128;
  /// Of the socket, where listen.http is a path; ParseSocketMode reads it.
  std::string socket_mode = "0660";
  /// PEM of listen.http; both or none. None: it speaks no TLS.
  std::string tls_certificate_file;
  std::string tls_key_file;
  /// Who may speak to an address of listen.http without TLS.
  std::vector<Network> plain_from = LoopbackNetworks();
  /// Lines as identity::TokenTable::Parse reads them; empty: there are no tokens.
  std::string tokens_file;
  /// A file whose first line is the token that listen.metrics asks for; empty: it asks for none.
  std::string metrics_token_file;
};

/// Reads three or four octal digits up to 0777; nothing if the text is anything else.
[[nodiscard]] std::optional<mode_t> ParseSocketMode(std::string_view text);

/// Whether listen.http speaks TLS.
[[nodiscard]] bool SpeaksTls(const HttpConfig& http);
/// Who may speak to listen.http without TLS. Where it speaks none, this machine always may: its
/// health checks and uplinkctl have no other way.
[[nodiscard]] std::vector<Network> PlainFrom(const HttpConfig& http);
/// Whether callers of listen.http must show a token or an operator's certificate. False: every
/// caller is identity::LocalCaller, and only this machine may get there.
[[nodiscard]] bool AsksForProof(const HttpConfig& http);

}  // namespace uplink::config
