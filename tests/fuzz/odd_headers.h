#pragma once

#include <cstdint>
#include <string>

#include "tests/support/relay_bytes.h"

namespace uplink::fuzz {

/// What a HEADERS frame that should open a call may be like.
enum class OddHeaders : std::uint8_t {
  kGood,
  kHalfClosed,
  kNoTrailers,
  kOtherPath,
  kGzip,
  kNoGrpc,
  kGet,
  kTimeout,
  kBadTimeout,
  kHuge,
  /// CONTINUATION must follow.
  kNotWhole,
  /// A number that was used before.
  kOldStream,
  /// A long header that HPACK keeps, and many that name it.
  kBombFuse,
  kBomb,
};
inline constexpr std::uint8_t kOddHeaders = 14;

/// The headers of a request that lacks something, or not; what is odd about the frame itself is
/// left to its sender.
[[nodiscard]] inline testing::http2::Fields FieldsOf(OddHeaders odd) {
  switch (odd) {
    case OddHeaders::kNoTrailers:
      return testing::RelayFields({{"te", ""}});
    case OddHeaders::kOtherPath:
      return testing::RelayFields({{":path", "/uplink.v1.UplinkRelay/Relays"}});
    case OddHeaders::kGzip:
      return testing::RelayFields({{"grpc-encoding", "gzip"}});
    case OddHeaders::kNoGrpc:
      return testing::RelayFields({{"content-type", "text/plain"}});
    case OddHeaders::kGet:
      return testing::RelayFields({{":method", "GET"}});
    case OddHeaders::kTimeout:
      return testing::RelayFields({{"grpc-timeout", "900m"}});
    case OddHeaders::kBadTimeout:
      return testing::RelayFields({{"grpc-timeout", "soon"}});
    case OddHeaders::kHuge:
      return testing::RelayFields({{"x-huge", std::string(9'000, 'h')}});
    case OddHeaders::kGood:
    case OddHeaders::kHalfClosed:
    case OddHeaders::kNotWhole:
    case OddHeaders::kOldStream:
    case OddHeaders::kBombFuse:
    case OddHeaders::kBomb:
      break;
  }
  return testing::RelayFields();
}

}  // namespace uplink::fuzz
