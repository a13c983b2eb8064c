#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include "server/robot/latest_by_key.h"

namespace uplink::cyberwave {

/// The latest value of each key: at most `kKeysMax` keys and `kBytesMax` bytes. The least recently
/// updated is evicted first. A value.
template <typename Value, std::size_t kKeysMax, std::size_t kBytesMax>
class LatestWithin {
 public:
  struct Sized {
    Value value;
    std::size_t bytes = 0;
  };

  /// `bytes`: the memory of key and value, their own size included. Returns the number of evicted
  /// keys, which include this one if it alone has no room.
  std::size_t Put(std::string key, Value value, std::size_t bytes) {
    std::size_t gone = latest_.Put(std::move(key), {.value = std::move(value), .bytes = bytes});
    while (this->bytes() > kBytesMax) {
      latest_.Erase(latest_.items().front().first);
      ++gone;
    }
    return gone;
  }

  /// Null if the key is not kept.
  [[nodiscard]] const Value* Find(std::string_view key) const {
    const Sized* found = latest_.Find(key);
    return found == nullptr ? nullptr : &found->value;
  }

  /// Key and Sized, least recently updated first.
  [[nodiscard]] const auto& items() const { return latest_.items(); }
  [[nodiscard]] std::size_t size() const { return latest_.items().size(); }
  [[nodiscard]] std::size_t bytes() const {
    std::size_t sum = 0;
    for (const auto& [key, sized] : latest_.items()) sum += sized.bytes;
    return sum;
  }

 private:
  robot::LatestByKey<Sized, kKeysMax> latest_;
};

}  // namespace uplink::cyberwave
