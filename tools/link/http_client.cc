#include "tools/link/http_client.h"

#include <charconv>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/ssl/error.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <fmt/core.h>
#include <openssl/err.h>
#include <openssl/ssl.h>

#include "schema/base/utf8.h"

namespace uplink::link {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;

using Places = std::vector<asio::generic::stream_protocol::endpoint>;
/// Of TCP or of a Unix socket.
using Plain = beast::basic_stream<asio::generic::stream_protocol>;
using Secure = asio::ssl::stream<Plain&>;

constexpr int kHttp11 = 11;
/// Bytes of an error's body that are repeated.
constexpr std::size_t kShownBytesMax = 300;
/// Of a socket's path: sockaddr_un has 108 with the NUL (unix(7)).
constexpr std::size_t kPathBytesMax = 107;

/// Which a Host header leaves out (RFC 9110, 4.2.1 and 4.2.2).
constexpr std::string_view kHttpPort = "80";
constexpr std::string_view kHttpsPort = "443";

bool IsPath(const std::string& address) { return address.starts_with('/'); }

/// Without its port.
std::string HostText(const std::string& host) {
  return host.find(':') == std::string::npos ? host : "[" + host + "]";
}

std::string WhyOf(const beast::error_code& error, milliseconds deadline) {
  if (error != beast::error::timeout && error != asio::error::timed_out) return error.message();
  return fmt::format("not done within {} ms", deadline.count());
}

/// A server that speaks no TLS answers a handshake by a text.
bool SpeaksPlain(const beast::error_code& error) {
  return error.category() == asio::error::get_ssl_category() &&
         ERR_GET_REASON(static_cast<unsigned long>(error.value())) == SSL_R_WRONG_VERSION_NUMBER;
}

}  // namespace

struct HttpClient::Connection {
  asio::io_context context;
  Plain plain{context};
  /// Around it, where the server is asked by TLS.
  std::optional<Secure> secure;
  beast::flat_buffer buffer;

  /// Runs one asynchronous operation to its end: only these know deadlines.
  template <typename Begin>
  beast::error_code Run(Begin begin) {
    beast::error_code result = asio::error::operation_aborted;
    begin([&result](beast::error_code error, auto&&...) { result = error; });
    context.restart();
    context.run();
    return result;
  }

  template <typename Request>
  beast::error_code Write(const Request& request) {
    return Run([&](auto handler) {
      if (secure) return http::async_write(*secure, request, std::move(handler));
      http::async_write(plain, request, std::move(handler));
    });
  }

  template <typename Parser>
  beast::error_code Read(Parser& parser) {
    return Run([&](auto handler) {
      if (secure) return http::async_read(*secure, buffer, parser, std::move(handler));
      http::async_read(plain, buffer, parser, std::move(handler));
    });
  }

  /// The places of a name. Nothing is asked for a literal address.
  beast::error_code Resolve(const std::string& host, const std::string& port, SteadyTime until,
                            Places& places) {
    beast::error_code result = asio::error::timed_out;
    asio::ip::tcp::resolver resolver(context);
    resolver.async_resolve(
        host, port,
        [&](beast::error_code error, const asio::ip::tcp::resolver::results_type& found) {
          result = error;
          for (const auto& each : found) places.emplace_back(each.endpoint());
        });
    context.restart();
    context.run_until(until);
    return result;
  }

  /// The first place that takes a connection; the error of the last one if none does.
  beast::error_code ConnectTo(const Places& places) {
    beast::error_code error = asio::error::host_not_found;
    for (const auto& place : places) {
      error = Run([&](auto handler) { plain.async_connect(place, std::move(handler)); });
      if (!error || error == beast::error::timeout) return error;
      plain.close();
    }
    return error;
  }
};

HttpClient::HttpClient(HttpServer server, const HttpLimits& limits)
    : server_(std::move(server)), limits_(limits) {
  const std::string& address = server_.address;
  if (IsPath(address)) return;
  const std::size_t colon = address.rfind(':');
  host_ = address.substr(0, colon);
  port_ = colon == std::string::npos ? "" : address.substr(colon + 1);
  if (host_.size() > 2 && host_.front() == '[' && host_.back() == ']') {
    host_ = host_.substr(1, host_.size() - 2);
  }
}

HttpClient::~HttpClient() = default;

absl::Status HttpClient::Failed(const std::string& target, std::string_view doing,
                                const std::string& why) {
  connection_.reset();
  const std::string where =
      IsPath(server_.address)
          ? fmt::format("unix:{} {}", server_.address, target)
          : fmt::format("{}://{}:{}{}", server_.tls == nullptr ? "http" : "https", HostText(host_),
                        port_, target);
  return absl::UnavailableError(fmt::format("{}: {}: {}", where, doing, why));
}

absl::StatusOr<HttpAnswer> HttpClient::Ask(const std::string& target) {
  const bool kept = connection_ != nullptr;
  absl::StatusOr<HttpAnswer> answer = AskOnce(target);
  // The server may have closed a connection that it kept; a fresh one tells.
  if (kept && absl::IsUnavailable(answer.status())) answer = AskOnce(target);
  return answer;
}

absl::StatusOr<HttpAnswer> HttpClient::Send(const std::string& target, const std::string& json) {
  connection_.reset();
  return AskOnce(target, &json);
}

absl::StatusOr<std::string> HttpClient::Get(const std::string& target) {
  absl::StatusOr<HttpAnswer> answer = Ask(target);
  if (!answer.ok()) return answer.status();
  if (answer->status == 200) return std::move(answer->body);
  return ErrorOf(target, *answer);
}

absl::Status ErrorOf(const std::string& target, const HttpAnswer& answer) {
  const std::string text = fmt::format("GET {}: {}: {}", target, answer.status,
                                       PrintableUtf8(answer.body, kShownBytesMax));
  if (answer.status == 404) return absl::NotFoundError(text);
  return absl::InternalError(text);
}

absl::Status HttpClient::Connect(const std::string& target, SteadyTime until) {
  connection_ = std::make_unique<Connection>();
  Places places;
  beast::error_code error;
  if (!IsPath(server_.address)) {
    error = connection_->Resolve(host_, port_, until, places);
  } else if (server_.address.size() <= kPathBytesMax) {
    places.emplace_back(asio::local::stream_protocol::endpoint(server_.address));
  } else {
    error = asio::error::name_too_long;
  }
  if (error == asio::error::timed_out) {
    // The thread that asks the system's resolver cannot be stopped, and the end of its context
    // would wait for it: both stay until the program ends.
    static_cast<void>(connection_.release());
  }
  if (error) return Failed(target, "resolve", WhyOf(error, limits_.deadline));
  connection_->plain.expires_at(until);
  error = connection_->ConnectTo(places);
  if (error) return Failed(target, "connect", WhyOf(error, limits_.deadline));
  return server_.tls == nullptr ? absl::OkStatus() : Handshake(target);
}

absl::Status HttpClient::Handshake(const std::string& target) {
  Secure& secure =
      connection_->secure.emplace(connection_->plain, server_.tls->NewSession(host_).release());
  const beast::error_code error = connection_->Run([&](auto handler) {
    secure.async_handshake(asio::ssl::stream_base::client, std::move(handler));
  });
  constexpr std::string_view kDoing = "TLS handshake";
  if (const std::string why = server_.tls->Distrust(*secure.native_handle()); !why.empty()) {
    return absl::UnauthenticatedError(
        Failed(target, kDoing, "the server's certificate is not believed: " + why).message());
  }
  if (!error) return absl::OkStatus();
  const std::string why = WhyOf(error, limits_.deadline);
  return Failed(target, kDoing, SpeaksPlain(error) ? why + "; does it speak http there?" : why);
}

absl::StatusOr<HttpAnswer> HttpClient::AskOnce(const std::string& target, const std::string* json) {
  const SteadyTime until = SystemClock().Steady() + limits_.deadline;
  const bool fresh = connection_ == nullptr;
  if (fresh) {
    if (absl::Status connected = Connect(target, until); !connected.ok()) return connected;
  }
  connection_->plain.expires_at(until);
  http::request<http::string_body> request(json == nullptr ? http::verb::get : http::verb::post,
                                           target, kHttp11);
  request.set(http::field::host,
              host_.empty() ? "localhost" : HostHeader(host_, port_, server_.tls != nullptr));
  request.set(http::field::accept, "application/json");
  if (!server_.token.empty()) request.set(http::field::authorization, "Bearer " + server_.token);
  if (json != nullptr) {
    request.set(http::field::content_type, "application/json");
    request.body() = *json;
    request.prepare_payload();
  }
  const beast::error_code unsent = connection_->Write(request);
  http::response_parser<http::string_body> parser;
  parser.body_limit(limits_.body_bytes_max);
  // Read in any case: a server that closed may have said why, as TLS 1.3 does of a certificate.
  const beast::error_code error = connection_->Read(parser);
  if (error && unsent && error.category() != asio::error::get_ssl_category()) {
    return Failed(target, "write", WhyOf(unsent, limits_.deadline));
  }
  if (error) {
    const std::string why = WhyOf(error, limits_.deadline);
    const bool broke_off = error == http::error::end_of_stream ||
                           error == http::error::partial_message ||
                           error == asio::error::connection_reset;
    // A server that wants TLS closes, perhaps after an alert.
    const bool wants_tls = fresh && broke_off && server_.tls == nullptr && !host_.empty();
    return Failed(target, "read", wants_tls ? why + "; does it want https?" : why);
  }
  auto response = parser.release();
  if (!response.keep_alive()) connection_.reset();
  const beast::string_view retry_after = response[http::field::retry_after];
  return HttpAnswer{
      response.result_int(), std::move(response.body()), {retry_after.data(), retry_after.size()}};
}

std::string HostHeader(const std::string& host, const std::string& port, bool tls) {
  if (port.empty() || port == (tls ? kHttpsPort : kHttpPort)) return HostText(host);
  return fmt::format("{}:{}", HostText(host), port);
}

std::string PercentEncoded(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '-' || c == '.' || c == '_' || c == '~';
    if (plain) {
      out.push_back(c);
    } else {
      out += fmt::format("%{:02X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    }
  }
  return out;
}

std::string PercentDecoded(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::uint8_t byte = 0;
    const char* const digits = text.data() + i + 1;
    if (text[i] == '%' && text.size() - i > 2 &&
        std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2) {
      out.push_back(static_cast<char>(byte));
      i += 2;
    } else {
      out.push_back(text[i]);
    }
  }
  return out;
}

}  // namespace uplink::link
