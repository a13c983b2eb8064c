#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "server/session/forward_source.h"
#include "storage/shared_items.h"

namespace uplink::forward {

using session::EncodedFrame;
using storage::ItemKey;

/// Shared by an item and all changes that wait. Immutable.
using KeyRef = std::shared_ptr<const ItemKey>;

/// Orders and finds by what a KeyRef refers to.
struct KeyOrder {
  using is_transparent = void;
  static const ItemKey& Of(const KeyRef& key) { return *key; }
  static const ItemKey& Of(const ItemKey& key) { return key; }
  template <typename A, typename B>
  bool operator()(const A& a, const B& b) const {
    return Of(a) < Of(b);
  }
};

struct KeyHash {
  std::size_t operator()(const KeyRef& key) const {
    return std::hash<std::string>()(key->id) * 31 + std::hash<std::string>()(key->ruri);
  }
};

struct KeyEqual {
  bool operator()(const KeyRef& a, const KeyRef& b) const { return a == b || *a == *b; }
};

/// What happens to an item.
enum class Change : std::uint8_t { kComes, kChanges, kGoes };

/// A shape or object as its fleet's robots get it. A value.
struct Item {
  EncodedFrame frame;
  /// Unix milliseconds; 0: never.
  std::int64_t expires_ms = 0;
};

}  // namespace uplink::forward
