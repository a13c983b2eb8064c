#include "tools/uplink-fleet/run/http_client.h"

#include <chrono>
#include <string_view>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <fmt/core.h>

namespace uplink::synthetic {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;

constexpr std::chrono::seconds kRequestDeadline{10};
constexpr int kHttp11 = 11;
/// Bytes of an error's body that are repeated.
constexpr std::size_t kShownBytesMax = 300;

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
};

HttpClient::HttpClient(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  host_ = address.substr(0, colon);
  port_ = colon == std::string::npos ? "" : address.substr(colon + 1);
  if (host_.size() > 2 && host_.front() == '[' && host_.back() == ']') {
    host_ = host_.substr(1, host_.size() - 2);
  }
}

HttpClient::~HttpClient() = default;

absl::StatusOr<std::string> HttpClient::Get(const std::string& target) {
  const bool kept = connection_ != nullptr;
  absl::StatusOr<std::string> answer = GetOnce(target);
  // The server may have closed a connection that it kept; a fresh one tells.
  if (kept && absl::IsUnavailable(answer.status())) answer = GetOnce(target);
  return answer;
}

absl::StatusOr<std::string> HttpClient::GetOnce(const std::string& target) {
  const auto failed = [&](std::string_view doing, const beast::error_code& error) {
    connection_.reset();
    return absl::UnavailableError(
        fmt::format("http://{}:{}{}: {}: {}", host_, port_, target, doing, error.message()));
  };
  if (connection_ == nullptr) {
    connection_ = std::make_unique<Connection>();
    beast::error_code error;
    asio::ip::tcp::resolver resolver(connection_->context);
    const auto found = resolver.resolve(host_, port_, error);
    if (error) return failed("resolve", error);
    connection_->stream.expires_after(kRequestDeadline);
    error = connection_->Run(
        [&](auto handler) { connection_->stream.async_connect(found, std::move(handler)); });
    if (error) return failed("connect", error);
  }
  http::request<http::empty_body> request(http::verb::get, target, kHttp11);
  request.set(http::field::host, host_);
  request.set(http::field::accept, "application/json");
  connection_->stream.expires_after(kRequestDeadline);
  beast::error_code error = connection_->Run(
      [&](auto handler) { http::async_write(connection_->stream, request, std::move(handler)); });
  if (error) return failed("write", error);
  http::response_parser<http::string_body> parser;
  parser.body_limit(kHttpBodyBytesMax);
  error = connection_->Run([&](auto handler) {
    http::async_read(connection_->stream, connection_->buffer, parser, std::move(handler));
  });
  if (error) return failed("read", error);
  const auto response = parser.release();
  if (!response.keep_alive()) connection_.reset();
  if (response.result() == http::status::ok) return response.body();
  const std::string text = fmt::format("GET {}: {}: {}", target, response.result_int(),
                                       response.body().substr(0, kShownBytesMax));
  if (response.result() == http::status::not_found) return absl::NotFoundError(text);
  return absl::InternalError(text);
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

}  // namespace uplink::synthetic
