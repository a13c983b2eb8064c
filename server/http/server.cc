#include "server/http/server.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <absl/status/status.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/steady_timer.hpp>
#include <fmt/core.h>

#include "server/http/connection.h"
#include "server/http/limits.h"

namespace uplink::http {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

/// Unknown if the peer is gone already.
Source SourceOfPeer(const tcp::socket& socket) {
  error_code error;
  const asio::ip::address address = socket.remote_endpoint(error).address();
  if (error) return {};
  const auto v6 = address.is_v6() ? address.to_v6()
                                  : asio::ip::make_address_v6(asio::ip::v4_mapped, address.to_v4());
  return SourceOf(v6.to_bytes());
}

/// At most half of what one source may have, so that each is read before it could give way.
std::size_t AcceptsPerTurn(const ListenerLimits& limits) {
  const std::size_t places = limits.source_share > 0 ? limits.source_share : limits.connections_max;
  return std::min(kAcceptsPerTurn, places / 2);
}

}  // namespace

/// Accepts for ever, up to kAcceptsPerTurn waiting connections in one turn of the loop. One
/// asynchronous accept is outstanding.
class HttpServer::Listener final : public std::enable_shared_from_this<HttpServer::Listener> {
 public:
  Listener(const Context& context, const Options& options)
      : context_(std::make_shared<ConnectionContext>(context, options)),
        accepts_per_turn_(AcceptsPerTurn(options.limits)),
        acceptor_(context.io),
        pause_(context.io) {}

  error_code Open(const tcp::endpoint& endpoint) {
    error_code error;
    acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(asio::socket_base::reuse_address(true), error);
    if (!error && endpoint.address().is_v6()) {
      acceptor_.set_option(asio::ip::v6_only(false), error);
    }
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
    if (!error) acceptor_.non_blocking(true, error);
    return error;
  }

  [[nodiscard]] config::ListenAddress bound() const {
    const tcp::endpoint endpoint = acceptor_.local_endpoint();
    return {endpoint.address().to_string(), endpoint.port()};
  }

  void Accept() {
    acceptor_.async_accept([self = shared_from_this()](error_code error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (error) return self->Rest();
      self->Admit(std::move(socket));
      self->AdmitThoseThatWait();
      self->Accept();
    });
  }

 private:
  /// A failure shows again in the accept that follows.
  void AdmitThoseThatWait() {
    for (std::size_t accepted = 1; accepted < accepts_per_turn_; ++accepted) {
      error_code error;
      tcp::socket socket(acceptor_.get_executor());
      acceptor_.accept(socket, error);
      if (error) return;
      Admit(std::move(socket));
    }
  }

  void Admit(tcp::socket socket) {
    const HttpServer::Context& server = context_->server;
    ConnectionProbe& probe = context_->probe();
    const Source source = SourceOfPeer(socket);
    switch (context_->places.MakeRoom(source, server.clock.Steady())) {
      case Places::Room::kNone: {
        probe.refused.Add();
        error_code ignored;
        socket.close(ignored);
        return;
      }
      case Places::Room::kGivenWay:
        probe.given_up.Add();
        break;
      case Places::Room::kFree:
        break;
    }
    ServeConnection(context_, std::move(socket), source);
  }

  void Rest() {
    pause_.expires_after(kAcceptPause);
    pause_.async_wait([self = shared_from_this()](error_code error) {
      if (!error) self->Accept();
    });
  }

  const std::shared_ptr<ConnectionContext> context_;
  const std::size_t accepts_per_turn_;
  tcp::acceptor acceptor_;
  asio::steady_timer pause_;
};

absl::StatusOr<std::unique_ptr<HttpServer>> HttpServer::Listen(const Context& context,
                                                               const Options& options) {
  error_code error;
  const asio::ip::address address = asio::ip::make_address(options.address.host, error);
  auto listener = std::make_shared<Listener>(context, options);
  if (!error) error = listener->Open(tcp::endpoint(address, options.address.port));
  if (error) {
    return absl::UnavailableError(
        fmt::format("{}: {} cannot be bound: {}; set an address of this machine and a free port",
                    KeyOf(options.listener), config::ToText(options.address), error.message()));
  }
  auto server = std::unique_ptr<HttpServer>(new HttpServer(listener));
  listener->Accept();
  return server;
}

HttpServer::HttpServer(std::shared_ptr<Listener> listener)
    : listener_(std::move(listener)), bound_(listener_->bound()) {}
HttpServer::~HttpServer() = default;

}  // namespace uplink::http
