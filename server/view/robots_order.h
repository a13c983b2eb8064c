#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/view/glance.h"
#include "server/view/robots_query.h"

namespace uplink::view {

/// Where a robot stands in a list. A value.
struct RobotsPlace {
  /// Empty: it has none, or the list is by RURI.
  std::optional<double> value{};
  std::string ruri;

  friend bool operator==(const RobotsPlace&, const RobotsPlace&) = default;
};

/// The place of a robot with this RURI. Pure.
[[nodiscard]] RobotsPlace PlaceOf(const RobotsOrder& order, const std::string& ruri,
                                  const Glance& glance);
/// Whether `a` comes before `b`. Pure.
[[nodiscard]] bool ComesBefore(const RobotsOrder& order, const RobotsPlace& a,
                               const RobotsPlace& b);

/// The token of the page that follows a robot at this place. A walk by it shows each robot that
/// keeps its value once; one whose value changes meanwhile may come twice, or not at all.
[[nodiscard]] std::string TokenAfter(const RobotsOrder& order, const RobotsPlace& place);
/// The place in a token that TokenAfter made for this order, or nothing.
[[nodiscard]] std::optional<RobotsPlace> PlaceFromToken(const RobotsOrder& order,
                                                        std::string_view token);

/// `battery`, or `-battery` for the other way round; nothing if it is no order.
[[nodiscard]] std::optional<RobotsOrder> RobotsOrderFromText(std::string_view text);

}  // namespace uplink::view
