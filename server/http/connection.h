#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <sys/stat.h>

#include "server/config/networks.h"
#include "server/http/handshakes.h"
#include "server/http/peer.h"
#include "server/http/places.h"
#include "server/http/server.h"
#include "server/http/tls_context.h"
#include "server/http/wire.h"
#include "server/log/rate_limited.h"

namespace uplink::http {

/// What all connections of a listener share. Confined to the loop's thread.
struct ConnectionContext {
  ConnectionContext(const HttpServer::Context& all, const HttpServer::Options& options)
      : server(all),
        listener(options.listener),
        limits(options.limits),
        tls(options.tls),
        plain_from(options.plain_from),
        group_alone((options.socket_mode & S_IRWXO) == 0),
        places(options.limits.connections_max, options.limits.source_share),
        handshakes(std::max<std::size_t>(options.limits.connections_max / 2, 1)),
        handshake_failures(all.logger) {}

  [[nodiscard]] ConnectionProbe& probe() const {
    return server.probe.connections[PlaceOf(listener)];
  }

  const HttpServer::Context server;
  const ListenerId listener;
  const ListenerLimits limits;
  /// Null: the listener speaks no TLS.
  const ServedTls* const tls;
  const std::vector<config::Network> plain_from;
  /// The Unix socket lets in its user and group alone, which may speak for others.
  const bool group_alone;
  /// The value of Keep-Alive.
  const std::string keep_alive = fmt::format(
      "timeout={}", std::chrono::duration_cast<std::chrono::seconds>(limits.idle_wait).count());
  Places places;
  Handshakes handshakes;
  log::RateLimited handshake_failures;
};

/// Serves one accepted socket of a peer, for whose source there is a place, until either side ends
/// it; keeps itself alive by its handlers. Confined to the loop's thread.
void ServeConnection(const std::shared_ptr<ConnectionContext>& context,
                     RawStream::socket_type socket, Peer peer);

}  // namespace uplink::http
