// listen.http with TLS: one port for HTTP and HTTPS, and what certificates of clients open there.
#include <array>
#include <csignal>
#include <cstring>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/http/guard.h"
#include "server/http/tls_context.h"
#include "server/http/wire.h"
#include "server/identity/pem.h"
#include "tests/component/http/http_server_fixture.h"
#include "tests/support/certificates.h"
#include "tests/support/eventually.h"
#include "tests/support/raw_http.h"
#include "tests/support/temp_folder.h"

namespace uplink::http {
namespace {

using ::testing::AllOf;
using testing::CertificateSpec;
using ::testing::HasSubstr;
using testing::KeyPair;
using testing::RawConnection;

constexpr const char* kAskRobots =
    "GET /api/v1/robots HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";

/// A client of HTTPS on 127.0.0.1 that verifies nothing. Reads give up after ten seconds.
class TlsConnection final {
 public:
  explicit TlsConnection(std::uint16_t port, const KeyPair& shows = {},
                         const std::string& alpn = {})
      : context_(SSL_CTX_new(TLS_client_method())), socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    if (!shows.certificate.empty()) {
      EXPECT_TRUE(identity::UseChain(context_.get(), shows.certificate));
      EXPECT_TRUE(identity::UseKey(context_.get(), shows.key));
    }
    const timeval wait{.tv_sec = 10, .tv_usec = 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof(wait));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    ssl_ = SSL_new(context_.get());
    SSL_set_fd(ssl_, socket_);
    if (!alpn.empty()) {
      SSL_set_alpn_protos(ssl_, reinterpret_cast<const unsigned char*>(alpn.data()),
                          static_cast<unsigned>(alpn.size()));
    }
    connected_ = SSL_connect(ssl_) == 1;
  }
  ~TlsConnection() {
    SSL_free(ssl_);
    ::close(socket_);
    ERR_clear_error();
  }
  TlsConnection(const TlsConnection&) = delete;
  TlsConnection& operator=(const TlsConnection&) = delete;

  [[nodiscard]] bool connected() const { return connected_; }
  [[nodiscard]] std::string protocol() const {
    const unsigned char* name = nullptr;
    unsigned size = 0;
    SSL_get0_alpn_selected(ssl_, &name, &size);
    return {reinterpret_cast<const char*>(name), size};
  }
  /// All that comes until the server ends; empty if it ends without an answer.
  std::string Ask(const std::string& request) {
    if (!connected_ || SSL_write(ssl_, request.data(), static_cast<int>(request.size())) <= 0) {
      return "";
    }
    std::string all;
    std::array<char, 4096> bytes{};
    for (int n = 0; (n = SSL_read(ssl_, bytes.data(), static_cast<int>(bytes.size()))) > 0;) {
      all.append(bytes.data(), static_cast<std::size_t>(n));
    }
    ended_ = SSL_get_shutdown(ssl_) == SSL_RECEIVED_SHUTDOWN;
    return all;
  }
  /// The server said that nothing follows.
  [[nodiscard]] bool ended() const { return ended_; }

 private:
  std::unique_ptr<SSL_CTX, SslContextFree> context_;
  int socket_;
  SSL* ssl_ = nullptr;
  bool connected_ = false;
  bool ended_ = false;
};

class TlsListenerTest : public HttpServerTest {
 protected:
  /// The server may end a connection while we write, and SSL_write has no MSG_NOSIGNAL.
  static void SetUpTestSuite() { std::signal(SIGPIPE, SIG_IGN); }

  TlsListenerTest() {
    WriteServer();
    Write("operators.crt", operators_.certificate());
    EXPECT_TRUE(tls_.Refresh().status.ok());
    guarded_.Open(world_.site);
  }
  ~TlsListenerTest() override { loop_.Stop(); }

  void Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.File(name)) << text;
  }
  void WriteServer() const {
    const KeyPair pair = operators_.Issue(testing::ServerSpec());
    Write("http.crt", pair.certificate);
    Write("http.key", pair.key);
  }

  std::uint16_t ServeTls(std::vector<config::Network> plain_from = config::LoopbackNetworks()) {
    ListenerLimits limits = kHttpLimits;
    limits.connections_max = kConnectionsMax;
    auto server = HttpServer::Listen({loop_.io(), guarded_, *memory_, *reads_, *metrics_, *scrapes_,
                                      *watches_, world_.http_probe, clock_, logger_},
                                     {.listener = ListenerId::kHttp,
                                      .address = {"127.0.0.1", 0},
                                      .limits = limits,
                                      .tls = &tls_,
                                      .plain_from = std::move(plain_from)});
    EXPECT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
    loop_.Start();
    return server_->bound().port;
  }

  [[nodiscard]] KeyPair Operator(const char* role, const char* fleet = "*") const {
    return operators_.Issue(OperatorSpec(role, fleet));
  }
  static CertificateSpec OperatorSpec(const char* role, const char* fleet = "*") {
    CertificateSpec spec;
    spec.common_names = {"anna"};
    spec.organizations = {fleet};
    spec.units = {role};
    return spec;
  }
  [[nodiscard]] std::int64_t Count(Denied why) const {
    return world_.http_probe.denied[static_cast<std::size_t>(why)].value();
  }

  const testing::TempFolder folder_;
  const testing::TestAuthority operators_;
  ServedTls tls_{{.certificate = folder_.File("http.crt"),
                  .key = folder_.File("http.key"),
                  .client_ca = folder_.File("operators.crt")},
                 transport::TlsRules()};
  Guard guard_{{clock_, logger_, world_.http_probe}, {.asks = true}};
  Entrance guarded_{KnownHosts(), Entrance::Covered::kData, &guard_};
};

TEST_F(TlsListenerTest, OnePortSpeaksBoth) {
  const std::uint16_t port = ServeTls();
  EXPECT_EQ(testing::HttpGet(port, "/livez").status, 200);
  TlsConnection connection(port, {}, "\2h2\10http/1.1");
  ASSERT_TRUE(connection.connected());
  EXPECT_EQ(connection.protocol(), "http/1.1");
  EXPECT_THAT(connection.Ask("GET /livez HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n"),
              HasSubstr("HTTP/1.1 200 OK\r\n"));
  EXPECT_TRUE(connection.ended()) << "it says that nothing follows";
}

TEST_F(TlsListenerTest, KeepsAConnectionForFurtherRequests) {
  TlsConnection connection(ServeTls(), Operator("viewer"));
  const std::string once = "GET /api/v1/robots HTTP/1.1\r\nHost: localhost\r\n\r\n";
  const std::string answers = connection.Ask(once + once + kAskRobots);
  std::size_t found = 0;
  for (std::size_t at = 0; (at = answers.find("HTTP/1.1 200", at)) != std::string::npos; ++at) {
    ++found;
  }
  EXPECT_EQ(found, 3U) << answers;
}

TEST_F(TlsListenerTest, AnOperatorsCertificateOpensWhatItsRoleMay) {
  const std::uint16_t port = ServeTls();
  EXPECT_THAT(TlsConnection(port, Operator("viewer")).Ask(kAskRobots), HasSubstr(" 200 OK\r\n"));
  EXPECT_THAT(TlsConnection(port, Operator("metrics")).Ask(kAskRobots),
              AllOf(HasSubstr(" 403 Forbidden\r\n"), HasSubstr("has the role metrics")));
  EXPECT_THAT(TlsConnection(port).Ask(kAskRobots),
              AllOf(HasSubstr(" 401 Unauthorized\r\n"), HasSubstr("WWW-Authenticate: Bearer\r\n")));
  loop_.Stop();
  EXPECT_THAT(lines_, ::testing::Contains(AllOf(HasSubstr("http_caller"), HasSubstr("role=viewer"),
                                                HasSubstr("from=127.0.0.1"))));
}

TEST_F(TlsListenerTest, ARobotsCertificateOpensNothing) {
  const KeyPair robot = operators_.Issue(testing::RobotSpec("rcan://local.rcan/a/b", "north"));
  EXPECT_THAT(TlsConnection(ServeTls(), robot).Ask(kAskRobots),
              AllOf(HasSubstr(" 403 Forbidden\r\n"), HasSubstr("has the role robot")));
}

TEST_F(TlsListenerTest, ACertificateThatIsNotGoodPassesTheHandshakeAndOpensNothing) {
  const std::uint16_t port = ServeTls();
  const testing::TestAuthority others("others");
  EXPECT_THAT(TlsConnection(port, others.Issue(OperatorSpec("admin"))).Ask(kAskRobots),
              AllOf(HasSubstr(" 401 "), HasSubstr("no authority of operators vouches for it")));
  CertificateSpec expired = OperatorSpec("admin");
  expired.not_after_s = -60;
  EXPECT_THAT(TlsConnection(port, operators_.Issue(expired)).Ask(kAskRobots),
              AllOf(HasSubstr(" 401 "), HasSubstr("has expired")));
  EXPECT_EQ(Count(Denied::kBadCertificate), 2);
}

TEST_F(TlsListenerTest, ACertificateThatIsNotExaminedEndsTheHandshake) {
  KeyPair shown = Operator("admin");
  const std::string one = shown.certificate;
  for (std::size_t i = 0; i < identity::kShownCertificatesMax; ++i) shown.certificate += one;
  TlsConnection connection(ServeTls(), shown);
  EXPECT_EQ(connection.Ask(kAskRobots), "");
  EXPECT_TRUE(testing::Eventually([&] { return Connections().open.value() == 0; }));
}

TEST_F(TlsListenerTest, WhoMayNotSpeakPlainIsClosedAndCounted) {
  const std::uint16_t port = ServeTls({});
  RawConnection plain(port);
  plain.SendGet("/livez");
  EXPECT_TRUE(plain.AtEnd());
  EXPECT_EQ(Count(Denied::kPlain), 1);
  EXPECT_THAT(TlsConnection(port, Operator("viewer")).Ask(kAskRobots), HasSubstr(" 200 OK\r\n"));
}

TEST_F(TlsListenerTest, AFirstMessageThatIsTooLargeEndsTheConnection) {
  RawConnection large(ServeTls());
  // A record of 16 KiB that holds a ClientHello of almost as much.
  std::string bytes = std::string("\x16\x03\x01\x40\x00\x01\x00\x3F\xFC\x03\x03", 11);
  bytes.append(kFirstMessageBytesMax + 1, 'x');
  large.Send(bytes);
  EXPECT_TRUE(large.AtEnd());
  RawConnection garbage(server_->bound().port);
  garbage.Send(std::string("\x16garbage of another protocol\r\n\r\n"));
  EXPECT_TRUE(testing::Eventually([&] { return Connections().open.value() <= 1; }));
  EXPECT_THAT(TlsConnection(server_->bound().port, Operator("viewer")).Ask(kAskRobots),
              HasSubstr(" 200 OK\r\n"));
}

TEST_F(TlsListenerTest, NewConnectionsUseFilesThatWereReplaced) {
  const std::uint16_t port = ServeTls();
  const testing::TestAuthority successors("successors");
  const KeyPair anna = successors.Issue(OperatorSpec("admin"));
  EXPECT_THAT(TlsConnection(port, anna).Ask(kAskRobots), HasSubstr(" 401 "));
  Write("operators.crt", successors.certificate());
  ASSERT_TRUE(tls_.Refresh().status.ok());
  EXPECT_THAT(TlsConnection(port, anna).Ask(kAskRobots), HasSubstr(" 200 OK\r\n"));
  Write("http.key", "no key");
  EXPECT_FALSE(tls_.Refresh().status.ok());
  EXPECT_THAT(TlsConnection(port, anna).Ask(kAskRobots), HasSubstr(" 200 OK\r\n"));
}

TEST_F(TlsListenerTest, FailuresCountForWhomAProxySpeaks) {
  const std::uint16_t port = ServeTls();
  const auto status = [port](const std::string& headers) {
    RawConnection connection(port);
    connection.Send("GET /api/v1/robots HTTP/1.1\r\nHost: localhost\r\n" + headers + "\r\n");
    return connection.Read().value_or(testing::RawAnswer()).status;
  };
  const std::string wrong = "Authorization: Bearer wrong\r\n";
  const std::string of_one = "X-Forwarded-For: 203.0.113.9, 192.0.2.7\r\n";
  for (int i = 0; i < 10; ++i) EXPECT_EQ(status(wrong + of_one), 401);
  EXPECT_EQ(status(wrong + of_one), 429);
  EXPECT_EQ(status(wrong + "X-Forwarded-For: 192.0.2.7, 203.0.113.9\r\n"), 401);
  EXPECT_EQ(status(wrong), 401) << "of the proxy itself";
  // By TLS a peer speaks for itself, whatever it says.
  EXPECT_THAT(TlsConnection(port).Ask("GET /api/v1/robots HTTP/1.1\r\nHost: localhost\r\n" +
                                      of_one + "Connection: close\r\n\r\n"),
              HasSubstr(" 401 "));
}

}  // namespace
}  // namespace uplink::http
