#include "server/http/server.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string>
#include <utility>

#include <absl/status/status.h>
#include <boost/asio/basic_socket_acceptor.hpp>
#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>
#include <fmt/core.h>

#include "server/http/connection.h"
#include "server/http/limits.h"
#include "server/http/unix_socket.h"

namespace uplink::http {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
/// Of TCP, or of a Unix socket.
using Protocol = asio::generic::stream_protocol;
using Endpoint = Protocol::endpoint;
using Socket = RawStream::socket_type;

sockaddr_storage AddressOf(const Endpoint& endpoint) {
  sockaddr_storage address{};
  std::memcpy(&address, endpoint.data(), std::min(endpoint.size(), sizeof(address)));
  return address;
}

/// Unknown if the peer is gone already.
Peer PeerOfSocket(const Socket& socket, const ConnectionContext& context) {
  error_code error;
  const Endpoint endpoint = socket.remote_endpoint(error);
  if (error) return {};
  Peer peer = PeerOf(AddressOf(endpoint), context.plain_from);
  if (context.listener == ListenerId::kMetrics) {
    peer.plain = true;
    peer.proxy = false;
  }
  if (peer.on_machine) peer.proxy = context.group_alone;
  return peer;
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
        address_(options.address),
        socket_mode_(options.socket_mode),
        acceptor_(context.io),
        pause_(context.io) {}

  absl::Status Open() {
    const bool is_path = config::IsUnix(address_);
    if (is_path) {
      if (absl::Status clear = ClearSocketPath(address_.path); !clear.ok()) return clear;
    }
    error_code error =
        is_path ? Bind(asio::local::stream_protocol::endpoint(address_.path)) : BindHost();
    if (error) return absl::UnavailableError(error.message());
    if (is_path) {
      if (absl::Status owned = file_.emplace().Own(address_.path, socket_mode_); !owned.ok())
        return owned;
    }
    acceptor_.listen(asio::socket_base::max_listen_connections, error);
    if (!error) acceptor_.non_blocking(true, error);
    return error ? absl::UnavailableError(error.message()) : absl::OkStatus();
  }

  [[nodiscard]] config::ListenAddress bound() const {
    if (config::IsUnix(address_)) return address_;
    const Endpoint any = acceptor_.local_endpoint();
    tcp::endpoint endpoint;
    endpoint.resize(any.size());
    std::memcpy(endpoint.data(), any.data(), any.size());
    return {endpoint.address().to_string(), endpoint.port()};
  }

  /// The handlers that wait on the loop may outlive the server.
  void RemoveFile() { file_.reset(); }

  void Accept() {
    acceptor_.async_accept([self = shared_from_this()](error_code error, Socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (error) return self->Rest();
      self->Admit(std::move(socket));
      self->AdmitThoseThatWait();
      self->Accept();
    });
  }

 private:
  error_code BindHost() {
    error_code error;
    const asio::ip::address host = asio::ip::make_address(address_.host, error);
    return error ? error : Bind(tcp::endpoint(host, address_.port));
  }

  error_code Bind(const Endpoint& endpoint) {
    error_code error;
    acceptor_.open(endpoint.protocol(), error);
    const int family = endpoint.protocol().family();
    if (!error && family != AF_UNIX) {
      acceptor_.set_option(asio::socket_base::reuse_address(true), error);
    }
    if (!error && family == AF_INET6) acceptor_.set_option(asio::ip::v6_only(false), error);
    if (!error) acceptor_.bind(endpoint, error);
    return error;
  }

  /// A failure shows again in the accept that follows.
  void AdmitThoseThatWait() {
    for (std::size_t accepted = 1; accepted < accepts_per_turn_; ++accepted) {
      error_code error;
      Socket socket(acceptor_.get_executor());
      acceptor_.accept(socket, error);
      if (error) return;
      Admit(std::move(socket));
    }
  }

  void Admit(Socket socket) {
    const HttpServer::Context& server = context_->server;
    ConnectionProbe& probe = context_->probe();
    Peer peer = PeerOfSocket(socket, *context_);
    if (context_->tls == nullptr && !peer.plain) {
      return server.entrance.NoteDenied(Denied::kPlain, peer);
    }
    switch (context_->places.MakeRoom(peer.source, server.clock.Steady(), peer.of())) {
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
    ServeConnection(context_, std::move(socket), std::move(peer));
  }

  void Rest() {
    pause_.expires_after(kAcceptPause);
    pause_.async_wait([self = shared_from_this()](error_code error) {
      if (!error) self->Accept();
    });
  }

  const std::shared_ptr<ConnectionContext> context_;
  const std::size_t accepts_per_turn_;
  const config::ListenAddress address_;
  const mode_t socket_mode_;
  std::optional<SocketFile> file_;
  asio::basic_socket_acceptor<Protocol> acceptor_;
  asio::steady_timer pause_;
};

absl::StatusOr<std::unique_ptr<HttpServer>> HttpServer::Listen(const Context& context,
                                                               const Options& options) {
  auto listener = std::make_shared<Listener>(context, options);
  if (absl::Status open = listener->Open(); !open.ok()) {
    return absl::UnavailableError(fmt::format(
        "{}: {} cannot be bound: {}{}", KeyOf(options.listener), config::ToText(options.address),
        std::string(open.message()),
        config::IsUnix(options.address) ? "" : "; set an address of this machine and a free port"));
  }
  auto server = std::unique_ptr<HttpServer>(new HttpServer(listener));
  listener->Accept();
  return server;
}

HttpServer::HttpServer(std::shared_ptr<Listener> listener)
    : listener_(std::move(listener)), bound_(listener_->bound()) {}
HttpServer::~HttpServer() { listener_->RemoveFile(); }

}  // namespace uplink::http
