#include "server/front/call/request_head.h"

#include <algorithm>

#include <fmt/format.h>

#include "schema/base/utf8.h"
#include "server/front/http2/limits.h"

namespace uplink::front {
namespace {

constexpr std::string_view kContentType = "application/grpc";
constexpr std::size_t kTimeoutDigitsMax = 8;
/// Bytes of an unknown encoding that the answer repeats.
constexpr std::size_t kEncodingShownMax = 32;

bool IsGrpc(std::string_view content_type) {
  if (!content_type.starts_with(kContentType)) return false;
  if (content_type.size() == kContentType.size()) return true;
  const char next = content_type[kContentType.size()];
  return next == '+' || next == ';';
}

}  // namespace

std::optional<milliseconds> ParseTimeout(std::string_view text) {
  if (text.size() < 2 || text.size() > kTimeoutDigitsMax + 1) return std::nullopt;
  std::int64_t number = 0;
  for (const char c : text.substr(0, text.size() - 1)) {
    if (c < '0' || c > '9') return std::nullopt;
    number = number * 10 + (c - '0');
  }
  using std::chrono::ceil;
  switch (text.back()) {
    case 'H':
      return std::chrono::hours(number);
    case 'M':
      return std::chrono::minutes(number);
    case 'S':
      return std::chrono::seconds(number);
    case 'm':
      return milliseconds(number);
    case 'u':
      return ceil<milliseconds>(std::chrono::microseconds(number));
    case 'n':
      return ceil<milliseconds>(std::chrono::nanoseconds(number));
    default:  // a letter of the wire
      return std::nullopt;
  }
}

bool RequestHead::Add(std::string_view name, std::string_view value) {
  const std::size_t bytes = name.size() + value.size() + kHeaderOverheadBytes;
  if (too_large_ || bytes > kHeaderBytesMax - bytes_) {
    too_large_ = true;
    return false;
  }
  bytes_ += static_cast<std::uint32_t>(bytes);
  if (name == ":method") {
    is_post_ = value == "POST";
  } else if (name == ":path") {
    path_ = value.substr(0, kPathBytesMax);
  } else if (name == "content-type") {
    is_grpc_ = IsGrpc(value);
  } else if (name == "te") {
    takes_trailers_ = value == "trailers";
  } else if (name == "grpc-encoding") {
    encoding_ = value == "identity" ? "" : value.substr(0, kEncodingShownMax);
  } else if (name == "authorization") {
    authorization_ = value;
  } else if (name == "grpc-timeout") {
    timeout_ = ParseTimeout(value);
    bad_timeout_ = !timeout_;
  }
  return true;
}

std::optional<int> RequestHead::NotGrpc() const {
  // Headers that were cut may have lost the field that says so.
  if (too_large_) return std::nullopt;
  if (!is_post_) return 405;
  if (!is_grpc_) return 415;
  return std::nullopt;
}

absl::Status RequestHead::Judge() const {
  if (too_large_) {
    return absl::ResourceExhaustedError(
        fmt::format("headers: over the limit of {} bytes", kHeaderBytesMax));
  }
  if (!takes_trailers_) return absl::InternalError("te: trailers is missing");
  if (foreign_encoding()) {
    return absl::UnimplementedError(fmt::format("grpc-encoding {}: only identity is taken",
                                                PrintableUtf8(encoding_, kEncodingShownMax)));
  }
  if (bad_timeout_) {
    return absl::InvalidArgumentError("grpc-timeout: not at most 8 digits and a unit of HMSmun");
  }
  return absl::OkStatus();
}

}  // namespace uplink::front
