// The least that a server over mutual TLS can do: reads length-prefixed frames, throws them away
// and says how many messages came. One thread, epoll and OpenSSL. A comparator.
#include <array>
#include <csignal>
#include <cstring>
#include <memory>
#include <string>
#include <unordered_map>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <openssl/ssl.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "schema/base/check.h"
#include "tests/bench/sink_protocol.h"

namespace uplink::bench {
namespace {

constexpr std::size_t kReadBytes = 16 * 1024;
constexpr int kEvents = 256;
constexpr int kBacklog = 4096;

struct Connection {
  std::unique_ptr<SSL, void (*)(SSL*)> session{nullptr, SSL_free};
  std::string in;
  std::uint64_t messages = 0;
  std::uint64_t acked = 0;
  bool up = false;
};

class Sink final {
 public:
  Sink(const std::string& folder, std::uint16_t port)
      : context_(SSL_CTX_new(TLS_server_method()), SSL_CTX_free), epoll_(epoll_create1(0)) {
    SSL_CTX* const context = context_.get();
    UPLINK_CHECK(
        SSL_CTX_use_certificate_file(context, (folder + "/server.crt").c_str(), SSL_FILETYPE_PEM) ==
                1 &&
            SSL_CTX_use_PrivateKey_file(context, (folder + "/server.key").c_str(),
                                        SSL_FILETYPE_PEM) == 1 &&
            SSL_CTX_load_verify_locations(context, (folder + "/ca.crt").c_str(), nullptr) == 1,
        "the certificates are read");
    SSL_CTX_set_verify(context, SSL_VERIFY_PEER | SSL_VERIFY_FAIL_IF_NO_PEER_CERT, nullptr);
    SSL_CTX_set_mode(context, SSL_MODE_RELEASE_BUFFERS);
    SSL_CTX_set_options(context, SSL_OP_NO_TICKET);  // TLS 1.2's
    SSL_CTX_set_num_tickets(context, 0);             // TLS 1.3's
    SSL_CTX_set_session_cache_mode(context, SSL_SESS_CACHE_OFF);
    listener_ = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(port);
    UPLINK_CHECK(
        bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
            listen(listener_, kBacklog) == 0,
        "the sink listens");
    Watch(listener_);
  }

  [[noreturn]] void Run() {
    std::array<epoll_event, kEvents> events{};
    while (true) {
      const int count = epoll_wait(epoll_, events.data(), kEvents, -1);
      for (int i = 0; i < count; ++i) {
        const int descriptor = events.at(static_cast<std::size_t>(i)).data.fd;
        if (descriptor == listener_) {
          Accept();
        } else if (!Serve(connections_.at(descriptor))) {
          connections_.erase(descriptor);
          close(descriptor);
        }
      }
    }
  }

 private:
  void Watch(int descriptor) const {
    epoll_event event{};
    event.events = EPOLLIN;
    event.data.fd = descriptor;
    epoll_ctl(epoll_, EPOLL_CTL_ADD, descriptor, &event);
  }

  void Accept() {
    for (int next = 0; (next = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK)) >= 0;) {
      const int on = 1;
      setsockopt(next, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
      Connection& connection = connections_[next];
      connection.session.reset(SSL_new(context_.get()));
      SSL_set_fd(connection.session.get(), next);
      SSL_set_accept_state(connection.session.get());
      Watch(next);
    }
  }

  /// False once the connection is over.
  bool Serve(Connection& connection) {
    SSL* const session = connection.session.get();
    if (!connection.up) {
      const int done = SSL_do_handshake(session);
      if (done != 1) return SSL_get_error(session, done) == SSL_ERROR_WANT_READ;
      connection.up = true;
    }
    while (true) {
      const int got = SSL_read(session, buffer_.data(), kReadBytes);
      if (got <= 0) return SSL_get_error(session, got) == SSL_ERROR_WANT_READ;
      connection.in.append(buffer_.data(), static_cast<std::size_t>(got));
      TakeFrames(connection);
    }
  }

  static void TakeFrames(Connection& connection) {
    std::size_t at = 0;
    SinkFrame frame;
    while (connection.in.size() - at >= sizeof frame) {
      std::memcpy(&frame, connection.in.data() + at, sizeof frame);
      if (connection.in.size() - at < sizeof frame + frame.bytes) break;
      at += sizeof frame + frame.bytes;
      connection.messages += frame.messages;
    }
    connection.in.erase(0, at);
    if (connection.messages - connection.acked < kMessagesAnAck) return;
    connection.acked = connection.messages;
    const SinkAck ack{connection.messages};
    // A few bytes: a benchmark's client reads them.
    SSL_write(connection.session.get(), &ack, sizeof ack);
  }

  std::unique_ptr<SSL_CTX, void (*)(SSL_CTX*)> context_;
  int epoll_;
  int listener_ = -1;
  std::unordered_map<int, Connection> connections_;
  std::array<char, kReadBytes> buffer_{};
};

}  // namespace
}  // namespace uplink::bench

/// tls_sink FOLDER PORT: the folder holds server.crt, server.key and ca.crt.
int main(int argc, char** argv) {
  if (argc != 3) return 2;
  std::signal(SIGPIPE, SIG_IGN);
  uplink::bench::Sink(argv[1], static_cast<std::uint16_t>(std::stoul(argv[2]))).Run();
}
