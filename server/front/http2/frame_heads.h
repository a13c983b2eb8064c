#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace uplink::front {

/// Reads the heads of a client's frames before nghttp2 does, and passes the bytes on.
///
/// It puts 0 in place of the last stream's number in each GOAWAY. That number is about streams that
/// the server opened, and we open none: it means nothing here. Clients write any number there
/// (grpc-go writes one of its own streams), and nghttp2 ends a connection for a number that it did
/// not expect.
///
/// It notices DATA of the stream that the client ended last. nghttp2 passes over that in silence
/// once the stream is closed.
///
/// Source: RFC 9113, 3.4 (the preface), 4.1 (a frame's head), 6.8 (GOAWAY).
/// Limits: keeps at most the head of one frame. Thread: confined to its connection's.
class FrameHeads final {
 public:
  /// Takes a first part off `bytes`, which must not be empty, and returns what nghttp2 reads in its
  /// place, of the same length.
  [[nodiscard]] std::string_view TakePart(std::string_view& bytes);
  /// The client ended this stream, or reset it.
  void NoteEnd(std::int32_t stream) { ended_ = static_cast<std::uint32_t>(stream); }
  /// DATA of it has begun since.
  [[nodiscard]] bool sent_past_end() const { return sent_past_end_; }

 private:
  static constexpr std::size_t kPrefaceBytes = 24;
  static constexpr std::size_t kHeadBytes = 9;

  /// The head of a frame is whole.
  void OnHead();

  /// Bytes to pass on as they are before the next head, unless the number comes first.
  std::size_t left_ = kPrefaceBytes;
  /// Bytes of the number that come next.
  std::size_t number_left_ = 0;
  std::array<std::uint8_t, kHeadBytes> head_{};
  std::size_t head_bytes_ = 0;
  /// No stream has the number 0.
  std::uint32_t ended_ = 0;
  bool sent_past_end_ = false;
};

}  // namespace uplink::front
