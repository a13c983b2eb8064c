#pragma once

#include <cstdint>
#include <string>
#include <string_view>

/// The language that fuzz_session reads (Input): one byte for the step, then what the step needs.
namespace uplink::fuzz {

enum class Step : std::uint8_t {
  /// A new stream of a robot. Byte: robot.
  kStream,
  /// The steps that follow are about another stream. Byte: which.
  kPick,
  /// A frame as it is. Two bytes, low first: its length; then the frame.
  kFrame,
  /// A Hello. Bytes: session, settled_seq, by how much judged_seq is above it.
  kHello,
  /// A batch. Byte: messages; each two bytes: by how much its number is above the last, content.
  kBatch,
  kBreak,
  kHalfClose,
  kTooLarge,
  /// Byte: grace in tenths of a second.
  kDrain,
  /// The agent reads no more, one frame, or all again.
  kStopReading,
  kReadOne,
  kReadAgain,
  /// One step of the journal.
  kJournal,
  kWakes,
  /// All that can be done.
  kCommit,
  /// Byte: time in units of 50 ms.
  kTime,
  /// The next call of the store fails. Byte: even before it is applied, odd with its answer lost.
  kStoreFails,
  kStoreAway,
  kStoreBack,
  /// Another process opens a robot. Byte: robot.
  kTaken,
  /// The process is killed and starts again.
  kRestart,
};
inline constexpr std::uint8_t kSteps = 21;

/// Writes a script in the same language.
class Script final {
 public:
  Script& Do(Step step, std::string_view arguments = {}) {
    bytes_ += static_cast<char>(step);
    bytes_ += arguments;
    return *this;
  }
  Script& Frame(std::string_view frame) {
    const std::string length{static_cast<char>(frame.size() & 0xFFU),
                             static_cast<char>(frame.size() >> 8U & 0xFFU)};
    return Do(Step::kFrame, length + std::string(frame));
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace uplink::fuzz
