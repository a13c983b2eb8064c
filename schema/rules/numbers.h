#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "schema/limits.h"
#include "schema/rules/describe.h"
#include "schema/rules/path.h"
#include "schema/rules/violations.h"

/// Rules of single numbers: each returns the value fit to keep, or reports the violation and
/// returns nothing.
namespace uplink::schema {

struct Bounds {
  double min;
  double max;
};

template <typename T>
[[nodiscard]] std::optional<T> Finite(Violations& violations, const Path& path, T value) {
  if (std::isfinite(value)) [[likely]]
    return value;
  violations.Content(NotFinite(path, static_cast<double>(value)));
  return std::nullopt;
}

template <typename T>
[[nodiscard]] std::optional<T> InRange(Violations& violations, const Path& path, T value,
                                       Bounds bounds) {
  const auto number = static_cast<double>(value);
  if (number >= bounds.min && number <= bounds.max) [[likely]]
    return value;
  violations.Content(std::isfinite(value) ? OutOfRange(path, number, bounds.min, bounds.max)
                                          : NotFinite(path, number));
  return std::nullopt;
}

template <typename T>
[[nodiscard]] std::optional<T> NotNegative(Violations& violations, const Path& path, T value) {
  if (value >= 0 && std::isfinite(value)) [[likely]]
    return value;
  const auto number = static_cast<double>(value);
  violations.Content(std::isfinite(value) ? BelowZero(path, number) : NotFinite(path, number));
  return std::nullopt;
}

/// A percentage; noise just beyond 0 and 100 is clamped.
[[nodiscard]] inline std::optional<float> Percent(Violations& violations, const Path& path,
                                                  float value) {
  const std::optional<float> kept =
      InRange(violations, path, value, {-kPercentSlack, kPercentMax + kPercentSlack});
  if (!kept) return std::nullopt;
  if (*kept <= 0) return 0.0F;  // also -0
  return *kept > static_cast<float>(kPercentMax) ? static_cast<float>(kPercentMax) : *kept;
}

/// For the fields in which robots write NaN for "not measured": nothing then, without a violation;
/// otherwise what `rule(value)` says.
template <typename T, typename Rule>
[[nodiscard]] std::optional<T> UnlessNan(T value, Rule rule) {
  if (std::isnan(value)) return std::nullopt;
  return rule(value);
}

/// A time of the robot's clock; 0 (unknown) if it is negative or from 2100 on, which is counted.
[[nodiscard]] inline std::int64_t Time(Violations& violations, std::int64_t unix_ms) {
  if (unix_ms >= 0 && unix_ms < kTimeMsEnd) [[likely]]
    return unix_ms;
  violations.CountUnknownTime();
  return 0;
}

}  // namespace uplink::schema
