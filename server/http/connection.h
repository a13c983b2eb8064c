#pragma once

#include <chrono>
#include <memory>
#include <string>

#include <boost/asio/ip/tcp.hpp>
#include <fmt/core.h>

#include "server/http/places.h"
#include "server/http/server.h"

namespace uplink::http {

/// What all connections of a listener share. Confined to the loop's thread.
struct ConnectionContext {
  ConnectionContext(const HttpServer::Context& all, const HttpServer::Options& options)
      : server(all),
        listener(options.listener),
        limits(options.limits),
        places(options.limits.connections_max, options.limits.source_share) {}

  [[nodiscard]] ConnectionProbe& probe() const {
    return server.probe.connections[PlaceOf(listener)];
  }

  const HttpServer::Context server;
  const ListenerId listener;
  const ListenerLimits limits;
  /// The value of Keep-Alive.
  const std::string keep_alive = fmt::format(
      "timeout={}", std::chrono::duration_cast<std::chrono::seconds>(limits.idle_wait).count());
  Places places;
};

/// Serves one accepted socket of a source, for which there is a place, until either side ends it;
/// keeps itself alive by its handlers. Confined to the loop's thread.
void ServeConnection(const std::shared_ptr<ConnectionContext>& context,
                     boost::asio::ip::tcp::socket socket, const Source& source);

}  // namespace uplink::http
