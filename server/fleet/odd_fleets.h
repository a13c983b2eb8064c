#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <string_view>

namespace uplink::fleet {

/// Odd names of fleets that are remembered; further ones of the store are refused like new ones.
inline constexpr std::size_t kOddFleetsMax = 1'000;

/// Fleets whose names hold a character that nobody sees, and that the store has robots of. Such a
/// name is no new fleet's: it would look like another one's. It is judged by its own form, never by
/// other names. Thread-safe.
class OddFleets final {
 public:
  enum class Verdict : std::uint8_t {
    /// Nothing is odd, or the store has robots of this fleet.
    kFits,
    kRefused,
    /// It is odd, and the store's robots were not read yet.
    kUnread,
  };

  /// The store has a robot of this fleet.
  void Know(std::string_view fleet);
  /// All of the store's robots were told.
  void SetRead();
  [[nodiscard]] Verdict Judge(std::string_view fleet) const;

 private:
  mutable std::mutex mutex_;
  bool read_ = false;
  std::set<std::string, std::less<>> known_;
};

}  // namespace uplink::fleet
