#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <string_view>

namespace uplink::fleet {

/// Odd names that are remembered; further ones in the store are refused like new ones.
inline constexpr std::size_t kOddFleetsMax = 1'000;

/// Which fleets may have an odd name, one with an invisible character
/// (identity::InvisibleCharacter): those whose robots the store has. A new fleet may not, since its
/// name can look like another's. A name is odd by itself; it is never compared with others.
///
/// Limits: kOddFleetsMax.
/// Thread: thread-safe.
class OddFleets final {
 public:
  enum class Verdict : std::uint8_t {
    /// The name is plain, or the store has robots of this fleet.
    kFits,
    /// The name is odd, and the store has no robot of this fleet.
    kRefused,
    /// The name is odd, and the store's robots were not read yet.
    kUnread,
  };

  /// The store has a robot of this fleet. A plain name is not remembered.
  void Know(std::string_view fleet);
  /// Know was called for all fleets of the store: a further odd name is new.
  void SetRead();
  [[nodiscard]] bool is_read() const {
    const std::lock_guard lock(mutex_);
    return read_;
  }
  [[nodiscard]] Verdict Judge(std::string_view fleet) const;

 private:
  mutable std::mutex mutex_;
  bool read_ = false;
  std::set<std::string, std::less<>> known_;
};

}  // namespace uplink::fleet
