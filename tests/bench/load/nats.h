#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace uplink::bench {

/// What a NATS server said: the front of received bytes. A value; views refer to those bytes.
struct NatsSaid {
  enum class Kind : std::uint8_t {
    kPartial,
    /// A message for a subscription; `text` is its payload.
    kMessage,
    kPing,
    kPong,
    /// `text` says which.
    kError,
    /// INFO and the like.
    kOther,
    kMalformed,
  };
  Kind kind = Kind::kPartial;
  std::string_view text;
  /// What all of it takes.
  std::size_t bytes = 0;
};

/// Source: the NATS client protocol, as its documentation describes it.
[[nodiscard]] NatsSaid ReadNats(std::string_view in);

}  // namespace uplink::bench
