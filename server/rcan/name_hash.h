#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string_view>

namespace uplink::rcan {

/// Hashes a text that a robot chose. The key is secret, so that no robot can make two texts with
/// the same hash: the second would count as known. Immutable.
class NameHash final {
 public:
  /// Drawn anew at each start of the process.
  using Key = std::array<std::uint64_t, 2>;
  /// `random` draws evenly.
  [[nodiscard]] static Key Draw(const std::function<std::uint64_t()>& random) {
    return {random(), random()};
  }

  explicit NameHash(const Key& key) : key_(key) {}

  [[nodiscard]] std::uint64_t operator()(std::string_view text) const;

 private:
  Key key_;
};

}  // namespace uplink::rcan
