#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// The bytes of HTTP/2 frames, right and wrong ones (Source: RFC 9113, 7541).
namespace uplink::testing::http2 {

inline constexpr std::size_t kHeadBytes = 9;

/// Types of frames, as they are on the wire.
enum Type : std::uint8_t {
  kData = 0,
  kHeaders = 1,
  kPriority = 2,
  kRstStream = 3,
  kSettings = 4,
  kPing = 6,
  kGoaway = 7,
  kWindowUpdate = 8,
  kContinuation = 9,
  /// Of no standard.
  kUnknown = 0xEE,
};

/// Flags; some share a bit, for frames of different types.
enum Flag : std::uint8_t {
  kNone = 0,
  kAck = 0x1,
  kEndStream = 0x1,
  kEndHeaders = 0x4,
  kPadded = 0x8,
};

/// Error codes.
enum Code : std::uint32_t {
  kNoError = 0,
  kProtocolError = 1,
  kFlowControlError = 3,
  kFrameSizeError = 6,
  kStreamClosed = 5,
  kRefusedStream = 7,
  kCancel = 8,
  kCompressionError = 9,
  kEnhanceYourCalm = 11,
};

/// Settings.
enum Setting : std::uint16_t {
  kHeaderTableSize = 1,
  kMaxConcurrentStreams = 3,
  kInitialWindowSize = 4,
};

using Fields = std::vector<std::pair<std::string, std::string>>;

/// What a client says first, before its SETTINGS.
[[nodiscard]] std::string Preface();
[[nodiscard]] std::string Frame(std::uint8_t type, std::uint8_t flags, std::uint32_t stream,
                                std::string_view payload = {});
/// Literals without indexing.
[[nodiscard]] std::string Hpack(const Fields& fields);
[[nodiscard]] std::string Headers(std::uint32_t stream, const Fields& fields,
                                  std::uint8_t flags = kEndHeaders);
/// In frames of at most 16 KiB; the flags belong to the last.
[[nodiscard]] std::string Data(std::uint32_t stream, std::string_view bytes,
                               std::uint8_t flags = kNone);
[[nodiscard]] std::string RstStream(std::uint32_t stream, std::uint32_t code);
[[nodiscard]] std::string Settings(
    const std::vector<std::pair<std::uint16_t, std::uint32_t>>& values);
[[nodiscard]] std::string SettingsAck();
[[nodiscard]] std::string Ping(std::string_view eight_bytes = "pingping");
/// The answer to a PING of the server, which says nothing in it.
[[nodiscard]] std::string Pong();
[[nodiscard]] std::string Priority(std::uint32_t stream);
[[nodiscard]] std::string WindowUpdate(std::uint32_t stream, std::uint32_t bytes);
[[nodiscard]] std::string Goaway(std::uint32_t code, std::uint32_t last_stream = 0);
/// The text, so many times.
[[nodiscard]] std::string Times(std::size_t count, std::string_view text);

/// A number of the wire, most significant byte first.
[[nodiscard]] std::uint32_t NumberOf(std::string_view bytes);

}  // namespace uplink::testing::http2
