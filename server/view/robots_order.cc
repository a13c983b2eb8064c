#include "server/view/robots_order.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>

#include <fmt/core.h>

#include "server/view/page_token.h"

namespace uplink::view {
namespace {

/// In place of a value: there is none.
constexpr std::string_view kNoValue = "-";

std::optional<double> ValueOf(RobotsBy by, const Glance& glance) {
  switch (by) {
    case RobotsBy::kRuri:
      break;
    case RobotsBy::kBattery:
      return glance.vitals.battery_percent;
    case RobotsBy::kLastHeard:
      if (glance.last_heard) return static_cast<double>(UnixMs(*glance.last_heard));
      break;
    case RobotsBy::kBacklog:
      if (glance.backlog) return static_cast<double>(*glance.backlog);
      break;
  }
  return std::nullopt;
}

/// Names the order in a token: `o2d.`.
std::string PrefixOf(const RobotsOrder& order) {
  return fmt::format("o{}{}.", static_cast<int>(order.by), order.descending ? 'd' : 'a');
}

std::optional<double> DoubleFromBits(std::string_view text) {
  std::uint64_t bits = 0;
  constexpr int kHex = 16;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), bits, kHex);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  const auto value = std::bit_cast<double>(bits);
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace

RobotsPlace PlaceOf(const RobotsOrder& order, const std::string& ruri, const Glance& glance) {
  return {.value = ValueOf(order.by, glance), .ruri = ruri};
}

bool ComesBefore(const RobotsOrder& order, const RobotsPlace& a, const RobotsPlace& b) {
  if (order.by == RobotsBy::kRuri) return order.descending ? b.ruri < a.ruri : a.ruri < b.ruri;
  if (a.value.has_value() != b.value.has_value()) return a.value.has_value();
  if (a.value != b.value) return order.descending ? *a.value > *b.value : *a.value < *b.value;
  return a.ruri < b.ruri;
}

std::string TokenAfter(const RobotsOrder& order, const RobotsPlace& place) {
  if (order == RobotsOrder()) return RobotsToken(place.ruri);
  const std::string value = place.value
                                ? fmt::format("{:x}", std::bit_cast<std::uint64_t>(*place.value))
                                : std::string(kNoValue);
  return PrefixOf(order) + value + "." + RobotsToken(place.ruri);
}

std::optional<RobotsPlace> PlaceFromToken(const RobotsOrder& order, std::string_view token) {
  RobotsPlace place;
  if (order != RobotsOrder()) {
    const std::string prefix = PrefixOf(order);
    if (!token.starts_with(prefix)) return std::nullopt;
    token.remove_prefix(prefix.size());
    const std::size_t end = token.find('.');
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view value = token.substr(0, end);
    if (value != kNoValue) {
      place.value = DoubleFromBits(value);
      if (!place.value) return std::nullopt;
    }
    token.remove_prefix(end + 1);
  }
  std::optional<std::string> ruri = RuriFromToken(token);
  if (!ruri) return std::nullopt;
  place.ruri = *std::move(ruri);
  return place;
}

std::optional<RobotsOrder> RobotsOrderFromText(std::string_view text) {
  RobotsOrder order{.descending = text.starts_with('-')};
  if (order.descending) text.remove_prefix(1);
  const auto* const name = std::ranges::find(kRobotsByNames, text);
  if (name == kRobotsByNames.end()) return std::nullopt;
  order.by = static_cast<RobotsBy>(name - kRobotsByNames.begin());
  return order;
}

}  // namespace uplink::view
