#pragma once

#include <atomic>
#include <cstddef>
#include <memory>

#include <boost/asio/ip/tcp.hpp>

#include "server/http/server.h"

namespace uplink::http {

/// What all connections of a listener share. The count is the bound's; the cell is what is shown.
struct ConnectionContext {
  ConnectionContext(const HttpServer::Context& all, milliseconds wait)
      : server(all), request_wait(wait) {}

  const HttpServer::Context server;
  const milliseconds request_wait;
  std::atomic<std::size_t> connections{0};
};

/// Serves one accepted socket until either side ends it; keeps itself alive by its handlers.
/// Confined to the loop's thread.
void ServeConnection(const std::shared_ptr<ConnectionContext>& context,
                     boost::asio::ip::tcp::socket socket);

}  // namespace uplink::http
