#include "tests/support/attack_bytes.h"

#include "tests/support/http2_frames.h"
#include "tests/support/relay_bytes.h"

namespace uplink::testing::attack {
namespace {

/// Of one frame; HTTP/2 allows 16,384 bytes.
constexpr std::size_t kFramePartBytes = 16'000;
/// HPACK's table holds 4,096 bytes, 32 more for each entry.
constexpr std::size_t kKeptValueBytes = 3'900;
/// HPACK: the newest entry of the table; and a literal that is kept there.
constexpr char kNewestKept = '\xBE';
constexpr char kKeepLiteral = '\x40';

}  // namespace

std::string Opened(std::uint32_t first, std::size_t streams) {
  std::string flood;
  for (std::size_t i = 0; i < streams; ++i) flood += OpenRelay(After(first, i));
  return flood;
}

std::string RapidResets(std::uint32_t first, std::size_t streams) {
  std::string flood;
  for (std::size_t i = 0; i < streams; ++i) {
    const std::uint32_t stream = After(first, i);
    flood += OpenRelay(stream) + http2::RstStream(stream, http2::kCancel);
  }
  return flood;
}

std::string Announcement(std::uint32_t stream, std::uint32_t bytes, std::size_t sent) {
  return OpenRelay(stream) + http2::Data(stream, Prefix(bytes) + std::string(sent, 'x'));
}

std::string LongHeader(std::uint32_t stream, std::size_t bytes) {
  const std::string block = http2::Hpack(RelayFields({{"x-long", std::string(bytes, 'x')}}));
  std::string frames;
  for (std::size_t at = 0; at < block.size(); at += kFramePartBytes) {
    const bool last = at + kFramePartBytes >= block.size();
    frames += http2::Frame(at == 0 ? http2::kHeaders : http2::kContinuation,
                           last ? http2::kEndHeaders : http2::kNone, stream,
                           block.substr(at, kFramePartBytes));
  }
  return frames;
}

std::string HeaderBombFuse(std::uint32_t stream) {
  std::string kept = http2::Hpack({{"a", std::string(kKeptValueBytes, 'b')}});
  kept.front() = kKeepLiteral;
  return http2::Frame(http2::kHeaders, http2::kEndHeaders, stream,
                      http2::Hpack(RelayFields()) + kept);
}

std::string HeaderBomb(std::uint32_t stream) {
  return http2::Frame(http2::kHeaders, http2::kEndHeaders, stream,
                      http2::Hpack(RelayFields()) + std::string(kFramePartBytes, kNewestKept));
}

std::string HeaderBombInTrailers(std::uint32_t stream) {
  return http2::Frame(http2::kHeaders, http2::kEndHeaders | http2::kEndStream, stream,
                      std::string(kFramePartBytes, kNewestKept));
}

std::string HeadersWithoutEnd(std::uint32_t stream) {
  return http2::Frame(http2::kHeaders, http2::kNone, stream, http2::Hpack(RelayFields()));
}

std::string EndlessContinuation(std::uint32_t stream) {
  return http2::Frame(http2::kContinuation, http2::kNone, stream,
                      http2::Hpack({{"a", std::string(kFramePartBytes, 'b')}}));
}

}  // namespace uplink::testing::attack
