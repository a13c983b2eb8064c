#pragma once

#include <array>
#include <string_view>

// The names of metrics' labels, for the catalogue alone.
namespace uplink::metrics {

inline constexpr std::array<std::string_view, 1> kByOutcome{"outcome"};
inline constexpr std::array<std::string_view, 1> kByReason{"reason"};
inline constexpr std::array<std::string_view, 2> kByVariantReason{"variant", "reason"};
inline constexpr std::array<std::string_view, 1> kByKind{"kind"};
inline constexpr std::array<std::string_view, 2> kBySourceKind{"source", "kind"};
inline constexpr std::array<std::string_view, 2> kByKindReason{"kind", "reason"};
inline constexpr std::array<std::string_view, 1> kByCode{"code"};
inline constexpr std::array<std::string_view, 1> kByPresence{"presence"};
inline constexpr std::array<std::string_view, 1> kByFleet{"fleet"};
inline constexpr std::array<std::string_view, 2> kByFleetWithin{"fleet", "within"};
inline constexpr std::array<std::string_view, 2> kByFleetPresence{"fleet", "presence"};
inline constexpr std::array<std::string_view, 2> kByRouteCode{"route", "code"};
inline constexpr std::array<std::string_view, 2> kByMethodOutcome{"method", "outcome"};
inline constexpr std::array<std::string_view, 1> kByListener{"listener"};
inline constexpr std::array<std::string_view, 1> kByCause{"cause"};
inline constexpr std::array<std::string_view, 1> kByShard{"shard"};
inline constexpr std::array<std::string_view, 1> kByVersion{"version"};
inline constexpr std::array<std::string_view, 1> kBySource{"source"};
inline constexpr std::array<std::string_view, 1> kByWhy{"why"};
inline constexpr std::array<std::string_view, 1> kByTopic{"topic"};
inline constexpr std::array<std::string_view, 2> kByTypeOutcome{"type", "outcome"};
inline constexpr std::array<std::string_view, 1> kByConnection{"connection"};
inline constexpr std::array<std::string_view, 2> kByConnectionReason{"connection", "reason"};
inline constexpr std::array<std::string_view, 2> kByConnectionQos{"connection", "qos"};
inline constexpr std::array<std::string_view, 2> kByConnectionWhy{"connection", "why"};

}  // namespace uplink::metrics
