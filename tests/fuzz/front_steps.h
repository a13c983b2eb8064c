#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

/// The languages that the targets of the transport read (Input): one byte for the step, then what
/// the step needs.
namespace uplink::fuzz {

/// Of fuzz_front_bytes: steps from this on are as many bytes of the robot's, and one more.
inline constexpr std::uint8_t kPlainBytes = 16;

enum class BytesStep : std::uint8_t {
  /// Two bytes, low first: how many; then the bytes.
  kMany,
  /// Byte: time in units of 50 ms.
  kTime,
  kWakes,
  /// The store does all that can be done.
  kCommit,
  /// The robot takes nothing that is sent, or all again.
  kStopReading,
  kReadAgain,
  /// The server drains. Byte: grace in units of 50 ms.
  kDrain,
  /// The bytes that follow are another connection's. Byte: robot.
  kConnect,
};
inline constexpr std::uint8_t kBytesSteps = 8;

/// Of fuzz_front_frames: three sorts of steps, one behind the other.
///
/// Messages of gRPC, and what is around them.
enum class MessageStep : std::uint8_t {
  /// Headers of a new stream. Byte: which headers, of OddHeaders.
  kOpen,
  /// A Hello. Byte: session.
  kHello,
  /// A batch. Byte: messages; each two bytes: by how much its number is above the last, content.
  kBatch,
  /// A message that is announced, and not whole. Two words: bytes in units of 8; bytes that come.
  kHalf,
  /// As many bytes more. Word.
  kMore,
  /// DATA as it is. Byte: how many; then the bytes.
  kData,
  /// DATA with padding. Byte: padding.
  kPadded,
  kHalfClose,
};
inline constexpr std::uint8_t kMessageSteps = 8;

/// Frames that are no message.
enum class FrameStep : std::uint8_t {
  /// Byte: code.
  kReset,
  kPing,
  /// Two bytes: setting, value as a power of 2.
  kSettings,
  kSettingsAck,
  /// Two bytes: of the stream if odd; bytes as a power of 2.
  kWindow,
  kPriority,
  /// Byte: how many; then the bytes of a header block.
  kContinuation,
  kGoaway,
  /// Three bytes: type, flags, how many; then the payload.
  kAny,
};
inline constexpr std::uint8_t kFrameSteps = 9;

/// What happens around them.
enum class WorldStep : std::uint8_t {
  /// A connection that has begun as it should. Byte: robot.
  kConnect,
  /// The steps that follow are about another connection; about another stream of it. Byte: which.
  kPickWire,
  kPickStream,
  /// From here on what is sent arrives in pieces. Byte: bytes of a piece; 0: whole.
  kPieces,
  /// The robot takes nothing that is sent, or all again.
  kStopReading,
  kReadAgain,
  kBreak,
  /// Byte: time in units of 50 ms.
  kTime,
  kWakes,
  /// One step of the store, and all.
  kJournal,
  kCommit,
  /// The next call of the store fails. Byte: even before it is applied, odd with its answer lost.
  kStoreFails,
  /// The connection has its age; the server drains. Byte: grace in units of 50 ms.
  kAge,
  kDrain,
  /// The connection asks whether its robot is there; ends.
  kKeepalive,
  kEnd,
};
inline constexpr std::uint8_t kWorldSteps = 16;

inline constexpr std::uint8_t kFramesSteps = kMessageSteps + kFrameSteps + kWorldSteps;

constexpr int ByteOf(BytesStep step) { return static_cast<int>(step); }
constexpr int ByteOf(MessageStep step) { return static_cast<int>(step); }
constexpr int ByteOf(FrameStep step) { return kMessageSteps + static_cast<int>(step); }
constexpr int ByteOf(WorldStep step) {
  return kMessageSteps + kFrameSteps + static_cast<int>(step);
}

/// Writes a script in one of the languages.
class FrontScript final {
 public:
  template <typename Step>
  FrontScript& Do(Step step, std::initializer_list<int> arguments = {}) {
    bytes_ += static_cast<char>(ByteOf(step));
    for (const int byte : arguments) bytes_ += static_cast<char>(byte);
    return *this;
  }
  FrontScript& Add(std::string_view bytes) {
    bytes_ += bytes;
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace uplink::fuzz
