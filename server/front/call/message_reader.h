#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/transport/call_handler.h"

namespace uplink::front {

using transport::kPrefixBytes;

/// The messages of one direction of a call, cut out of its DATA bytes: wherever those are cut.
///
/// A message that lies whole in what just arrived is a view of it; only what is not taken yet is
/// kept. Bounded by whoever feeds it: by the stream's window.
/// Confined to its connection's thread.
class MessageReader final {
 public:
  struct Next {
    enum class Kind : std::uint8_t {
      /// Not yet, or not whole.
      kNone,
      kMessage,
      /// Longer than the limit; nothing of it need be kept.
      kTooLarge,
      /// Its flag says that it is compressed, or has a value that means nothing.
      kBadFlag,
    };
    Kind kind = Kind::kNone;
    /// Of kMessage: valid until the next Add, Keep or Pop.
    std::string_view message;
    /// The length that the prefix states.
    std::uint64_t bytes = 0;
  };

  explicit MessageReader(std::uint64_t message_bytes_max = 0) : bytes_max_(message_bytes_max) {}

  /// Bytes of the largest message from the next one on.
  void SetMax(std::uint64_t message_bytes_max) { bytes_max_ = message_bytes_max; }

  /// Bytes arrived; they must stay valid until Keep.
  void Add(std::string_view chunk);
  /// What comes next, without taking it.
  [[nodiscard]] Next Peek() const;
  /// Takes the message that Peek showed; says how many bytes that were, with the prefix.
  std::size_t Pop();
  /// Messages that were taken.
  [[nodiscard]] std::uint64_t popped() const { return popped_; }
  /// Keeps what has not been taken: the bytes that Add was given may go.
  void Keep();
  /// Forgets all.
  void Clear();

  /// Bytes that arrived and were not taken.
  [[nodiscard]] std::size_t waiting() const { return Rest().size(); }
  /// Memory that is kept for them.
  [[nodiscard]] std::size_t held() const { return kept_.capacity(); }
  /// The whole length, prefix included, of a message that has begun within the limit and is not
  /// whole; nothing else.
  [[nodiscard]] std::optional<std::size_t> unfinished() const;

 private:
  /// All that was not taken, in one piece.
  [[nodiscard]] std::string_view Rest() const;

  std::uint64_t bytes_max_;
  /// What was kept, from kept_from_ on; with bytes in it nothing else waits.
  std::string kept_;
  std::size_t kept_from_ = 0;
  std::uint64_t popped_ = 0;
  /// The rest of what Add was given.
  std::string_view fresh_;
};

}  // namespace uplink::front
