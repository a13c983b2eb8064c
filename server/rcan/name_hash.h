#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string_view>

namespace uplink::rcan {

/// Stands for a text that a robot chose: by a secret key, so that nobody outside can make two texts
/// with the same number, of which the second would count as known. Immutable.
class NameHash final {
 public:
  /// Drawn anew for each life of the process.
  using Key = std::array<std::uint64_t, 2>;
  /// `random` gives evenly drawn numbers.
  [[nodiscard]] static Key Draw(const std::function<std::uint64_t()>& random) {
    return {random(), random()};
  }

  explicit NameHash(const Key& key) : key_(key) {}

  [[nodiscard]] std::uint64_t operator()(std::string_view text) const;

 private:
  Key key_;
};

}  // namespace uplink::rcan
