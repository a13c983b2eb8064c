#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "schema/model/layer_role.h"
#include "schema/model/spatial.h"

/// What robots receive about the shapes and objects of others: NexusCommands of generation 0.1.
namespace uplink::nexus_command {

/// The raw bytes of a UUID.
using CommandId = std::array<std::uint8_t, 16>;

/// A random UUID (version 4, RFC 4122); `random` gives evenly drawn numbers and is called twice.
[[nodiscard]] CommandId RandomCommandId(const std::function<std::uint64_t()>& random);

/// The id by which other robots know an item: `<id>@<origin RURI>`. Robots may choose the same ids,
/// and a command names only an id.
[[nodiscard]] std::string ForwardedId(std::string_view id, std::string_view origin_ruri);

/// The id by which the origin knows the item: what is before `@<origin RURI>`. Nothing if the
/// forwarded id is of no item of that robot. An id and a RURI may hold `@` and `@rcan://`, so this
/// is the one way to take a forwarded id apart. The view leads into `forwarded_id`.
[[nodiscard]] std::optional<std::string_view> OriginalId(std::string_view forwarded_id,
                                                         std::string_view origin_ruri);

/// A shape as robots receive it: a ReportedShape without its expiry. A value.
struct Shape {
  model::AssetIdentity identity;
  model::ShapeData data;
  model::LayerRole area_type = model::LayerRole::kAllowedArea;
  model::ScopeType scope = model::ScopeType::kRobot;
  /// Metres; both 0: no vertical bounds.
  double min_z_m = 0;
  double max_z_m = 0;
  std::int32_t level_id = 0;

  friend bool operator==(const Shape&, const Shape&) = default;
};

struct ShapeDeletion {
  std::string id;

  friend bool operator==(const ShapeDeletion&, const ShapeDeletion&) = default;
};

struct ObjectDeletion {
  std::string id;

  friend bool operator==(const ObjectDeletion&, const ObjectDeletion&) = default;
};

/// One command, of the kinds that the server sends. Ids are forwarded ids. A value.
struct Command {
  CommandId id{};
  std::variant<Shape, model::Object, ShapeDeletion, ObjectDeletion> what;

  friend bool operator==(const Command&, const Command&) = default;
};

}  // namespace uplink::nexus_command
