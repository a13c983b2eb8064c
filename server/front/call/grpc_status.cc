#include "server/front/call/grpc_status.h"

#include <nghttp2/nghttp2.h>

namespace uplink::front {

int GrpcCode(absl::StatusCode code) {
  constexpr int kUnknown = 2;
  constexpr int kLast = 16;
  const int number = static_cast<int>(code);
  // Abseil may add codes.
  return number >= 0 && number <= kLast ? number : kUnknown;
}

std::string PercentEncoded(std::string_view text) {
  constexpr std::string_view kHex = "0123456789ABCDEF";
  std::string encoded;
  encoded.reserve(text.size());
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte <= 0x7E && c != '%') {
      encoded += c;
      continue;
    }
    encoded += '%';
    encoded += kHex[byte >> 4U];
    encoded += kHex[byte & 0xFU];
  }
  return encoded;
}

absl::StatusCode CodeOfReset(std::uint32_t http2_code) {
  switch (http2_code) {
    case NGHTTP2_REFUSED_STREAM:
      return absl::StatusCode::kUnavailable;
    case NGHTTP2_CANCEL:
    case NGHTTP2_NO_ERROR:
      return absl::StatusCode::kCancelled;
    case NGHTTP2_ENHANCE_YOUR_CALM:
      return absl::StatusCode::kResourceExhausted;
    case NGHTTP2_INADEQUATE_SECURITY:
      return absl::StatusCode::kPermissionDenied;
    default:  // the wire may carry other codes
      return absl::StatusCode::kInternal;
  }
}

}  // namespace uplink::front
