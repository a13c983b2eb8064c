#pragma once

#include <memory>
#include <string>

#include <absl/status/statusor.h>

namespace uplink::synthetic {

/// Bytes of the largest answer that is read: a page of 1,000 rows with long texts fits.
inline constexpr std::size_t kHttpBodyBytesMax = std::size_t{64} * 1024 * 1024;

/// Fetches JSON from the server's HTTP listener, over one connection that is opened again when it
/// ends. Every request has a deadline of 10 s.
///
/// Errors: kUnavailable if the server cannot be reached or breaks off, kNotFound for 404, kInternal
///         for other answers; each names the path.
/// Thread: confined to the thread that made it; blocks.
class HttpClient final {
 public:
  /// `address` is HOST:PORT, an IPv6 host in brackets.
  explicit HttpClient(const std::string& address);
  ~HttpClient();
  HttpClient(const HttpClient&) = delete;
  HttpClient& operator=(const HttpClient&) = delete;

  /// The body of a 200 answer to `GET target`.
  [[nodiscard]] absl::StatusOr<std::string> Get(const std::string& target);

 private:
  struct Connection;
  [[nodiscard]] absl::StatusOr<std::string> GetOnce(const std::string& target);

  std::string host_;
  std::string port_;
  std::unique_ptr<Connection> connection_;
};

/// `text` with every byte but letters, digits and `-._~` as %XX.
[[nodiscard]] std::string PercentEncoded(const std::string& text);

}  // namespace uplink::synthetic
