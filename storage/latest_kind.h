#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "schema/model/variants.h"

namespace uplink::storage {

/// The kinds whose latest message the store keeps for each robot.
enum class LatestKind : std::uint8_t { kAgentInfo = 0, kSettings = 1, kUiCapabilities = 2 };
inline constexpr std::size_t kLatestKinds = 3;
inline constexpr std::array<LatestKind, kLatestKinds> kEachLatestKind = {
    LatestKind::kAgentInfo, LatestKind::kSettings, LatestKind::kUiCapabilities};

/// Some of them, by BitOf.
using LatestKindSet = std::uint32_t;
inline constexpr LatestKindSet kAllLatestKinds = (1U << kLatestKinds) - 1;
[[nodiscard]] constexpr LatestKindSet BitOf(LatestKind kind) {
  return 1U << static_cast<unsigned>(kind);
}

/// The messages of a kind.
[[nodiscard]] constexpr model::Variant VariantOf(LatestKind kind) {
  constexpr std::array<model::Variant, kLatestKinds> kVariants = {model::Variant::kAgentInfo,
                                                                  model::Variant::kCurrentSettings,
                                                                  model::Variant::kUiCapabilities};
  return kVariants[static_cast<std::size_t>(kind)];
}
/// Nothing of messages that are of none of the kinds.
[[nodiscard]] constexpr std::optional<LatestKind> LatestKindOf(model::Variant variant) {
  for (const LatestKind kind : kEachLatestKind) {
    if (VariantOf(kind) == variant) return kind;
  }
  return std::nullopt;
}

}  // namespace uplink::storage
