#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "tools/link/server_tls.h"

namespace uplink::link {

/// What a client puts up with. A value.
struct HttpLimits {
  /// Of the lookup of the name, and again from the connect to the last byte of the answer. A kept
  /// connection that fails is tried once more on a new one.
  milliseconds deadline = std::chrono::seconds(10);
  /// Bytes of an answer's body: a page of 1,000 rows with long texts fits.
  std::size_t body_bytes_max = std::size_t{64} * 1024 * 1024;
};

/// Which server is asked, and who asks. A value.
struct HttpServer {
  /// HOST:PORT, an IPv6 host in brackets; or the path of a Unix socket, which begins with a slash.
  std::string address;
  /// Null: it is asked without TLS.
  std::shared_ptr<const ServerTls> tls = {};
  /// A bearer token; empty: none is shown.
  std::string token = {};
};

struct HttpAnswer {
  unsigned status = 0;
  std::string body;
  /// The header Retry-After; empty if there is none.
  std::string retry_after = {};
};

/// What Get returns for an answer that is not 200: the beginning of its body, as a terminal may
/// have it.
[[nodiscard]] absl::Status ErrorOf(const std::string& target, const HttpAnswer& answer);

/// Fetches pages from the server's HTTP listener, and sends commands to it, over one connection
/// that is opened again when it ends.
///
/// Errors: kUnavailable if the server cannot be reached, breaks off, does not speak HTTP or is not
///         done within a deadline; kUnauthenticated if it shows no certificate that is believed.
///         Each names the URL.
/// Thread: confined to the thread that made it; blocks.
class HttpClient final {
 public:
  explicit HttpClient(HttpServer server, const HttpLimits& limits = {});
  /// Without TLS and token.
  explicit HttpClient(const std::string& address, const HttpLimits& limits = {})
      : HttpClient(HttpServer{address}, limits) {}
  ~HttpClient();
  HttpClient(const HttpClient&) = delete;
  HttpClient& operator=(const HttpClient&) = delete;

  /// The answer to `GET target`, whatever its status.
  [[nodiscard]] absl::StatusOr<HttpAnswer> Ask(const std::string& target);
  /// The answer to `POST target` with a body of JSON, whatever its status. Sent once: a connection
  /// that breaks off does not tell whether the server has done it.
  [[nodiscard]] absl::StatusOr<HttpAnswer> Send(const std::string& target, const std::string& json);
  /// The body of a 200 answer.
  ///
  /// Errors: kNotFound for 404 and kInternal for other answers as well; each names the path.
  [[nodiscard]] absl::StatusOr<std::string> Get(const std::string& target);

 private:
  struct Connection;
  /// `json`: what is posted; null for GET.
  [[nodiscard]] absl::StatusOr<HttpAnswer> AskOnce(const std::string& target,
                                                   const std::string* json = nullptr);
  [[nodiscard]] absl::Status Connect(const std::string& target, SteadyTime until);
  [[nodiscard]] absl::Status Handshake(const std::string& target);
  /// Ends the connection.
  [[nodiscard]] absl::Status Failed(const std::string& target, std::string_view doing,
                                    const std::string& why);

  const HttpServer server_;
  const HttpLimits limits_;
  /// Both empty for a Unix socket.
  std::string host_;
  std::string port_;
  std::unique_ptr<Connection> connection_;
};

/// The Host header of a request: `host` in brackets if it is an IPv6 address, and `port` unless it
/// is the scheme's own.
[[nodiscard]] std::string HostHeader(const std::string& host, const std::string& port, bool tls);

/// `text` with every byte but letters, digits and `-._~` as %XX.
[[nodiscard]] std::string PercentEncoded(const std::string& text);
/// What PercentEncoded made of it.
[[nodiscard]] std::string PercentDecoded(std::string_view text);

}  // namespace uplink::link
