#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "schema/model/held_bytes.h"
#include "server/robot/latest_by_key.h"
#include "server/robot/limits.h"

namespace uplink::robot {

/// Memory of an item beside its value: the key's string, a node of the list, a node and a bucket of
/// the index, and the allocator's overhead of both nodes.
inline constexpr std::size_t kPlaceBytes = 136;

/// Bytes of one item of a part. A value.
struct ItemBytes {
  /// Its content: about what a checkpoint writes of it.
  std::size_t content = 0;
  /// All of its memory.
  std::size_t held = 0;
};

/// For a message that contains its key.
template <typename Message>
[[nodiscard]] ItemBytes BytesOfItem(const std::string& key, const Message& message) {
  const std::size_t content = sizeof(message) + model::HeldBytes(message);
  return {.content = content, .held = content + model::HeldBytes(key) + kPlaceBytes};
}

/// A part with keys: the latest value of each, at most `kKeysMax` and kLivePartBytesMax bytes. The
/// least recently updated is evicted first. It counts its bytes as they change. A value.
template <typename Value, std::size_t kKeysMax>
class KeyedPart {
 public:
  using Latest = LatestByKey<Value, kKeysMax>;

  KeyedPart() = default;
  KeyedPart(const KeyedPart& other) : latest_(other.latest_) { Recount(); }
  KeyedPart& operator=(const KeyedPart& other) {
    if (this != &other) {
      latest_ = other.latest_;
      Recount();
    }
    return *this;
  }
  KeyedPart(KeyedPart&& other) noexcept
      : latest_(std::move(other.latest_)),
        content_bytes_(std::exchange(other.content_bytes_, 0)),
        held_bytes_(std::exchange(other.held_bytes_, 0)) {}
  KeyedPart& operator=(KeyedPart&& other) noexcept {
    latest_ = std::move(other.latest_);
    content_bytes_ = std::exchange(other.content_bytes_, 0);
    held_bytes_ = std::exchange(other.held_bytes_, 0);
    return *this;
  }
  ~KeyedPart() = default;

  /// Returns the number of evicted keys, which include this one if it alone has no room.
  std::size_t Put(std::string key, Value value) {
    if (const auto* before = latest_.FindItem(key)) {
      Uncount(*before);
    } else if (items().size() == kKeysMax) {
      Uncount(items().front());
    }
    std::size_t gone = latest_.Put(std::move(key), std::move(value));
    // Counts the item as kept: a short text may lie in the memory of a longer one before it.
    Count(items().back());
    while (content_bytes_ > kLivePartBytesMax) {
      Uncount(items().front());
      latest_.Erase(items().front().first);
      ++gone;
    }
    return gone;
  }

  /// Adds older values below these, as many as there is room for.
  void PutOnTopOf(KeyedPart older) {
    for (const auto& [key, value] : items()) older.Put(key, value);
    *this = std::move(older);
  }

  /// Null if the key is not kept.
  [[nodiscard]] const Value* Find(std::string_view key) const { return latest_.Find(key); }
  /// Least recently updated first.
  [[nodiscard]] const typename Latest::Items& items() const { return latest_.items(); }
  /// Memory of its items.
  [[nodiscard]] std::size_t held_bytes() const { return held_bytes_; }

 private:
  void Count(const typename Latest::Items::value_type& item) {
    const ItemBytes bytes = BytesOfItem(item.first, item.second);
    content_bytes_ += bytes.content;
    held_bytes_ += bytes.held;
  }
  void Uncount(const typename Latest::Items::value_type& item) {
    const ItemBytes bytes = BytesOfItem(item.first, item.second);
    content_bytes_ -= bytes.content;
    held_bytes_ -= bytes.held;
  }
  /// A copied text takes only the memory that it needs.
  void Recount() {
    content_bytes_ = held_bytes_ = 0;
    for (const auto& item : items()) Count(item);
  }

  Latest latest_;
  std::size_t content_bytes_ = 0;
  std::size_t held_bytes_ = 0;
};

}  // namespace uplink::robot
