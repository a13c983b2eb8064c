#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>

#include "schema/nexus_command/command.h"
#include "schema/nexus_command/encode.h"
#include "uplink/v1/fleet.pb.h"

/// What a robot remembers of the shapes and objects of others: their names, and a fingerprint of
/// their contents in place of the contents.
namespace uplink::synthetic {

/// How robots know an item of another one. A value.
struct ItemName {
  nexus_command::ItemKind kind = nexus_command::ItemKind::kShape;
  /// `<id>@<origin RURI>`
  std::string id;

  friend bool operator==(const ItemName&, const ItemName&) = default;
};

/// Shared by all robots of a thread that hold the item. Immutable.
using ItemRef = std::shared_ptr<const ItemName>;

struct ItemHash {
  std::size_t operator()(const ItemRef& item) const {
    return std::hash<std::string>()(item->id) * 2 + static_cast<std::size_t>(item->kind);
  }
};
struct ItemEqual {
  bool operator()(const ItemRef& a, const ItemRef& b) const { return a == b || *a == *b; }
};

/// Items to something of each.
template <typename Value>
using ItemMap = std::unordered_map<ItemRef, Value, ItemHash, ItemEqual>;

/// For people.
[[nodiscard]] std::string Shown(const ItemName& item);

/// The item belongs to that robot, by its id.
[[nodiscard]] bool IsOf(const ItemName& item, std::string_view ruri);

// The same for equal contents, as a robot receives them and as the server shows them. Neither the
// name is part of it, nor a shape's expiry, which robots do not receive.
[[nodiscard]] std::uint64_t FingerprintOf(v1::Shape row);
[[nodiscard]] std::uint64_t FingerprintOf(v1::TrackedObject row);
[[nodiscard]] std::uint64_t FingerprintOf(const nexus_command::Shape& shape);
[[nodiscard]] std::uint64_t FingerprintOf(const model::Object& object);

}  // namespace uplink::synthetic
