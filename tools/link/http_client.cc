#include "tools/link/http_client.h"

#include <utility>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <fmt/core.h>

#include "schema/base/utf8.h"

namespace uplink::link {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;

using Found = asio::ip::tcp::resolver::results_type;

constexpr int kHttp11 = 11;
/// Bytes of an error's body that are repeated.
constexpr std::size_t kShownBytesMax = 300;

/// Without its port.
std::string HostText(const std::string& host) {
  return host.find(':') == std::string::npos ? host : "[" + host + "]";
}

/// Which a Host header leaves out (RFC 9110, 4.2.1).
constexpr std::string_view kDefaultPort = "80";

std::string WhyOf(const beast::error_code& error, milliseconds deadline) {
  if (error != beast::error::timeout && error != asio::error::timed_out) return error.message();
  return fmt::format("not done within {} ms", deadline.count());
}

}  // namespace

struct HttpClient::Connection {
  asio::io_context context;
  beast::tcp_stream stream{context};
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

  /// The places of a name. Nothing is asked for a literal address.
  beast::error_code Resolve(const std::string& host, const std::string& port, SteadyTime until,
                            Found& found) {
    beast::error_code result = asio::error::timed_out;
    asio::ip::tcp::resolver resolver(context);
    resolver.async_resolve(host, port, [&](beast::error_code error, Found places) {
      result = error;
      found = std::move(places);
    });
    context.restart();
    context.run_until(until);
    return result;
  }
};

HttpClient::HttpClient(const std::string& address, const HttpLimits& limits) : limits_(limits) {
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
  return absl::UnavailableError(
      fmt::format("http://{}:{}{}: {}: {}", HostText(host_), port_, target, doing, why));
}

absl::StatusOr<HttpAnswer> HttpClient::Ask(const std::string& target) {
  const bool kept = connection_ != nullptr;
  absl::StatusOr<HttpAnswer> answer = AskOnce(target);
  // The server may have closed a connection that it kept; a fresh one tells.
  if (kept && absl::IsUnavailable(answer.status())) answer = AskOnce(target);
  return answer;
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
  Found found;
  beast::error_code error = connection_->Resolve(host_, port_, until, found);
  if (error == asio::error::timed_out) {
    // The thread that asks the system's resolver cannot be stopped, and the end of its context
    // would wait for it: both stay until the program ends.
    static_cast<void>(connection_.release());
  }
  if (error) return Failed(target, "resolve", WhyOf(error, limits_.deadline));
  connection_->stream.expires_at(until);
  error = connection_->Run(
      [&](auto handler) { connection_->stream.async_connect(found, std::move(handler)); });
  if (error) return Failed(target, "connect", WhyOf(error, limits_.deadline));
  return absl::OkStatus();
}

absl::StatusOr<HttpAnswer> HttpClient::AskOnce(const std::string& target) {
  const SteadyTime until = SystemClock().Steady() + limits_.deadline;
  if (connection_ == nullptr) {
    if (absl::Status connected = Connect(target, until); !connected.ok()) return connected;
  }
  connection_->stream.expires_at(until);
  http::request<http::empty_body> request(http::verb::get, target, kHttp11);
  request.set(http::field::host, HostHeader(host_, port_));
  request.set(http::field::accept, "application/json");
  beast::error_code error = connection_->Run(
      [&](auto handler) { http::async_write(connection_->stream, request, std::move(handler)); });
  if (error) return Failed(target, "write", WhyOf(error, limits_.deadline));
  http::response_parser<http::string_body> parser;
  parser.body_limit(limits_.body_bytes_max);
  error = connection_->Run([&](auto handler) {
    http::async_read(connection_->stream, connection_->buffer, parser, std::move(handler));
  });
  if (error) return Failed(target, "read", WhyOf(error, limits_.deadline));
  auto response = parser.release();
  if (!response.keep_alive()) connection_.reset();
  const beast::string_view retry_after = response[http::field::retry_after];
  return HttpAnswer{
      response.result_int(), std::move(response.body()), {retry_after.data(), retry_after.size()}};
}

std::string HostHeader(const std::string& host, const std::string& port) {
  if (port.empty() || port == kDefaultPort) return HostText(host);
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

}  // namespace uplink::link
