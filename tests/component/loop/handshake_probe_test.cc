#include "server/loop/handshake_probe.h"

#include <algorithm>
#include <atomic>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <openssl/bio.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "server/front/door/proxy_header.h"
#include "server/loop/client_hello.h"
#include "tests/support/certificates.h"
#include "tests/support/kept_lines.h"

namespace uplink::loop {
namespace {

/// Listens on a free port; what happens to its connections is the test's.
class Listener {
 public:
  Listener() : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    EXPECT_EQ(listen(socket_, 4), 0);
    const timeval deadline{20, 0};  // so that the test fails if no probe comes
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &deadline, sizeof(deadline));
    socklen_t size = sizeof(address);
    EXPECT_EQ(getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    port_ = ntohs(address.sin_port);
  }
  ~Listener() { close(socket_); }

  [[nodiscard]] std::uint16_t port() const { return port_; }

  /// Accepts one connection, reads a little, answers and closes. Says what it read, and from which
  /// port it came.
  std::string AnswerOnce(const std::string& answer, std::uint16_t* came_from = nullptr) const {
    sockaddr_in address{};
    socklen_t address_size = sizeof(address);
    const int peer = accept(socket_, reinterpret_cast<sockaddr*>(&address), &address_size);
    if (came_from != nullptr) *came_from = ntohs(address.sin_port);
    char bytes[2048];
    const ssize_t size = recv(peer, bytes, sizeof(bytes), 0);
    EXPECT_GT(size, 0);
    send(peer, answer.data(), answer.size(), MSG_NOSIGNAL);
    close(peer);
    return {bytes, static_cast<std::size_t>(std::max<ssize_t>(size, 0))};
  }

 private:
  int socket_;
  std::uint16_t port_ = 0;
};

/// Listens on ::1 and accepts nothing.
class Ipv6Listener {
 public:
  explicit Ipv6Listener(std::uint16_t port) : socket_(socket(AF_INET6, SOCK_STREAM, 0)) {
    sockaddr_in6 address{};
    address.sin6_family = AF_INET6;
    address.sin6_addr = in6addr_loopback;
    address.sin6_port = htons(port);
    bound_ = bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0 &&
             listen(socket_, 4) == 0;
  }
  ~Ipv6Listener() { close(socket_); }
  [[nodiscard]] bool bound() const { return bound_; }

 private:
  int socket_;
  bool bound_ = false;
};

class HandshakeProbeTest : public ::testing::Test {
 protected:
  HandshakeProbeTest() { loop_.Start(); }

  bool Probe(std::uint16_t port, milliseconds wait = std::chrono::seconds(10),
             const std::string& host = "127.0.0.1",
             const std::vector<config::Network>& proxy_protocol_from = {}) {
    std::promise<bool> answered;
    loop_.Post([&] {
      ProbeHandshake(loop_,
                     {{host, port}, proxy_protocol_from, std::string(front::kLocalProxyHeader)},
                     wait, [&](bool good) { answered.set_value(good); });
    });
    return answered.get_future().get();
  }

  bool ProbeAnsweredWith(const std::string& answer) {
    const Listener listener;
    const std::jthread peer([&] { listener.AnswerOnce(answer); });
    return Probe(listener.port());
  }

  SystemClock clock_;
  log::Logger logger_{std::make_unique<testing::NoLines>(), clock_, log::Format::kText,
                      log::Level::kError};
  EventLoop loop_{logger_};
};

TEST_F(HandshakeProbeTest, AServerHelloIsASign) {
  EXPECT_TRUE(ProbeAnsweredWith({"\x16\x03\x03\x00\x7a\x02", 6}));
}

TEST_F(HandshakeProbeTest, AnAlertAndOtherBytesAreNone) {
  EXPECT_FALSE(ProbeAnsweredWith({"\x15\x03\x03\x00\x02\x02\x28", 7}));
  EXPECT_FALSE(ProbeAnsweredWith("HTTP/1.1 400 Bad Request\r\n\r\n"));
  EXPECT_FALSE(ProbeAnsweredWith("\x16\x03"));
}

TEST_F(HandshakeProbeTest, AListenerThatAcceptsAndSaysNothingIsNone) {
  const Listener silent;
  EXPECT_FALSE(Probe(silent.port(), milliseconds(50)));
}

TEST_F(HandshakeProbeTest, AClosedPortIsNone) {
  std::uint16_t port = 0;
  {
    const Listener gone;
    port = gone.port();
  }
  EXPECT_FALSE(Probe(port));
}

TEST_F(HandshakeProbeTest, AnUnspecifiedAddressIsAskedByItsLoopback) {
  const Listener listener;
  const std::jthread peer([&] { listener.AnswerOnce({"\x16\x03\x03\x00\x7a\x02", 6}); });
  EXPECT_TRUE(Probe(listener.port(), std::chrono::seconds(10), "0.0.0.0"));
}

// Where a load balancer of this machine stands before the listener, we come from its address.
TEST_F(HandshakeProbeTest, AListenerThatWantsAProxyHeaderFromUsGetsOneOfOurOwn) {
  const auto said_to = [this](const char* network) {
    const Listener listener;
    std::string said;
    std::jthread peer([&] { said = listener.AnswerOnce({"\x16\x03\x03\x00\x7a\x02", 6}); });
    EXPECT_TRUE(Probe(listener.port(), std::chrono::seconds(10), "127.0.0.1",
                      {*config::Network::Parse(network)}));
    peer.join();
    return said;
  };
  const std::string with = said_to("127.0.0.0/8");
  EXPECT_TRUE(with.starts_with(front::kLocalProxyHeader));
  EXPECT_EQ(with.substr(front::kLocalProxyHeader.size(), 2), "\x16\x03");
  EXPECT_EQ(said_to("192.0.2.0/24").substr(0, 2), "\x16\x03");
}

TEST_F(HandshakeProbeTest, ThePortThatItComesFromIsTold) {
  const Listener listener;
  std::uint16_t came_from = 0;
  std::jthread peer([&] { listener.AnswerOnce({"\x16\x03\x03\x00\x7a\x02", 6}, &came_from); });
  std::atomic<std::uint16_t> told = 0;
  std::promise<bool> answered;
  loop_.Post([&] {
    ProbeHandshake(loop_, {.address = {"127.0.0.1", listener.port()}, .own_port = &told},
                   std::chrono::seconds(10), [&](bool good) { answered.set_value(good); });
  });
  EXPECT_TRUE(answered.get_future().get());
  peer.join();
  EXPECT_NE(came_from, 0);
  EXPECT_EQ(told, came_from);
}

// As on a machine without IPv6, or where gRPC found none: the listener has IPv4 alone.
TEST_F(HandshakeProbeTest, AnAnyAddressOfIpv6IsAskedByIpv4WhereNobodyListensOnIpv6) {
  const Listener listener;
  const std::jthread peer([&] { listener.AnswerOnce({"\x16\x03\x03\x00\x7a\x02", 6}); });
  EXPECT_TRUE(Probe(listener.port(), std::chrono::seconds(10), "::"));
}

TEST_F(HandshakeProbeTest, AnAnyAddressOfIpv6WithNobodyBehindItIsNone) {
  std::uint16_t port = 0;
  {
    const Listener gone;
    port = gone.port();
  }
  EXPECT_FALSE(Probe(port, std::chrono::seconds(10), "::"));
}

TEST_F(HandshakeProbeTest, AnIpv6ListenerThatSaysNothingIsNoneThoughIpv4WouldAnswer) {
  const Listener answers;
  const Ipv6Listener silent(answers.port());
  if (!silent.bound()) return;  // no IPv6 here
  std::atomic<bool> asked = false;
  std::jthread peer([&] {
    answers.AnswerOnce({"\x16\x03\x03\x00\x7a\x02", 6});
    asked = true;
  });
  EXPECT_FALSE(Probe(answers.port(), milliseconds(50), "::"));
  EXPECT_FALSE(asked);
  EXPECT_TRUE(Probe(answers.port())) << "so that the peer ends";
}

// OpenSSL's own server answers the hello, TLS 1.2 or 1.3.
class ClientHelloTest : public ::testing::TestWithParam<int> {};

TEST_P(ClientHelloTest, GetsAServerHello) {
  const testing::TestAuthority authority;
  const testing::KeyPair pair = authority.Issue(testing::ServerSpec());
  const std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context(SSL_CTX_new(TLS_server_method()),
                                                                  SSL_CTX_free);
  SSL_CTX_set_max_proto_version(context.get(), GetParam());
  const std::unique_ptr<BIO, decltype(&BIO_free)> certificate(
      BIO_new_mem_buf(pair.certificate.data(), static_cast<int>(pair.certificate.size())),
      BIO_free);
  const std::unique_ptr<BIO, decltype(&BIO_free)> key(
      BIO_new_mem_buf(pair.key.data(), static_cast<int>(pair.key.size())), BIO_free);
  X509* x509 = PEM_read_bio_X509(certificate.get(), nullptr, nullptr, nullptr);
  EVP_PKEY* pkey = PEM_read_bio_PrivateKey(key.get(), nullptr, nullptr, nullptr);
  ASSERT_EQ(SSL_CTX_use_certificate(context.get(), x509), 1);
  ASSERT_EQ(SSL_CTX_use_PrivateKey(context.get(), pkey), 1);
  X509_free(x509);
  EVP_PKEY_free(pkey);
  const std::unique_ptr<SSL, decltype(&SSL_free)> ssl(SSL_new(context.get()), SSL_free);
  BIO* in = BIO_new(BIO_s_mem());
  BIO* out = BIO_new(BIO_s_mem());
  SSL_set_bio(ssl.get(), in, out);
  const std::string hello = MakeClientHello();
  ASSERT_FALSE(hello.empty());
  BIO_write(in, hello.data(), static_cast<int>(hello.size()));
  SSL_accept(ssl.get());
  std::string answer(kServerHelloPrefix, '\0');
  ASSERT_EQ(BIO_read(out, answer.data(), static_cast<int>(answer.size())),
            static_cast<int>(answer.size()));
  EXPECT_TRUE(IsServerHello(answer));
}

INSTANTIATE_TEST_SUITE_P(Versions, ClientHelloTest,
                         ::testing::Values(TLS1_2_VERSION, TLS1_3_VERSION));

}  // namespace
}  // namespace uplink::loop
