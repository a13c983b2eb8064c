#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/transport/call_handler.h"

namespace uplink::front {

using transport::kPrefixBytes;

/// Cuts the messages of one direction of a call out of its DATA bytes, whose pieces may end
/// anywhere.
///
/// A message that lies whole in one piece is a view of it; only bytes that are not taken yet are
/// copied. The caller bounds them, by the stream's window.
class MessageReader final {
 public:
  struct Next {
    enum class Kind : std::uint8_t {
      /// None, or an incomplete one.
      kNone,
      kMessage,
      /// Longer than the limit; its bytes need not be kept.
      kTooLarge,
      /// Its flag says that it is compressed, or is invalid.
      kBadFlag,
    };
    Kind kind = Kind::kNone;
    /// Of kMessage: valid until the next Add, Keep or Pop.
    std::string_view message;
    /// The length that the prefix states.
    std::uint64_t bytes = 0;
  };

  explicit MessageReader(std::uint64_t message_bytes_max = 0) : bytes_max_(message_bytes_max) {}

  /// Sets the limit from the next message on.
  void SetMax(std::uint64_t message_bytes_max) { bytes_max_ = message_bytes_max; }

  /// Bytes arrived; they must stay valid until Keep.
  void Add(std::string_view chunk);
  /// The next message, without taking it.
  [[nodiscard]] Next Peek() const;
  /// Takes the message that Peek showed; returns its bytes, prefix included.
  std::size_t Pop();
  /// Messages that were taken.
  [[nodiscard]] std::uint64_t popped() const { return popped_; }
  /// Copies what has not been taken: the bytes given to Add may go.
  void Keep();
  /// Forgets all.
  void Clear();

  /// Bytes that arrived and were not taken.
  [[nodiscard]] std::size_t waiting() const { return Rest().size(); }
  /// Memory that is kept for them.
  [[nodiscard]] std::size_t held() const { return kept_.capacity(); }
  /// The length, prefix included, of a message within the limit that has begun and is incomplete;
  /// otherwise empty.
  [[nodiscard]] std::optional<std::size_t> unfinished() const;

 private:
  /// All that was not taken, in one piece.
  [[nodiscard]] std::string_view Rest() const;

  std::uint64_t bytes_max_;
  /// Copied bytes, from kept_from_ on; while there are some, no other bytes wait.
  std::string kept_;
  std::size_t kept_from_ = 0;
  std::uint64_t popped_ = 0;
  /// The rest of what Add was given.
  std::string_view fresh_;
};

}  // namespace uplink::front
