#pragma once

#include <memory>

#include <boost/asio/ip/tcp.hpp>

#include "server/http/places.h"
#include "server/http/server.h"

namespace uplink::http {

/// What all connections of a listener share. Confined to the loop's thread.
struct ConnectionContext {
  ConnectionContext(const HttpServer::Context& all, const HttpServer::Options& options)
      : server(all), request_wait(options.request_wait), places(options.connections_max) {}

  const HttpServer::Context server;
  const milliseconds request_wait;
  Places places;
};

/// Serves one accepted socket, for which there is a place, until either side ends it; keeps itself
/// alive by its handlers.
/// Confined to the loop's thread.
void ServeConnection(const std::shared_ptr<ConnectionContext>& context,
                     boost::asio::ip::tcp::socket socket);

}  // namespace uplink::http
