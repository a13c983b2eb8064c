#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "schema/limits.h"
#include "schema/model/enum_text.h"
#include "schema/model/uncrew/fields.h"
#include "schema/rules/motion.h"
#include "schema/rules/numbers.h"
#include "schema/rules/path.h"
#include "schema/rules/texts.h"
#include "schema/rules/violations.h"

namespace uplink::uncrew {

/// Whether a struct says anything.
template <model::uncrew::Listed Struct>
[[nodiscard]] bool IsKnown(const Struct& body) {
  return std::apply(
      [&](const auto&... field) {
        return ((body.*field.member != std::remove_cvref_t<decltype(body.*field.member)>{}) || ...);
      },
      model::uncrew::kFields<Struct>);
}

/// The fields of one struct by their names: each read returns the value fit to keep, or reports the
/// violation. A number that is absent or NaN is not known. Confined to one judgement; path and
/// violations outlive it.
class Reader final {
 public:
  Reader(schema::Violations& violations, const schema::Path& path)
      : violations_(violations), path_(path) {}

  /// Any finite number.
  template <typename T>
  [[nodiscard]] std::optional<T> Finite(std::string_view name, bool there, T value) {
    return Known(there, value,
                 [&] { return schema::Finite(violations_, path_.Field(name), value); });
  }
  template <typename T>
  [[nodiscard]] std::optional<T> InRange(std::string_view name, bool there, T value,
                                         schema::Bounds bounds) {
    return Known(there, value,
                 [&] { return schema::InRange(violations_, path_.Field(name), value, bounds); });
  }
  template <typename T>
  [[nodiscard]] std::optional<T> NotNegative(std::string_view name, bool there, T value) {
    return Known(there, value,
                 [&] { return schema::NotNegative(violations_, path_.Field(name), value); });
  }
  [[nodiscard]] std::optional<float> Percent(std::string_view name, bool there, float value) {
    return Known(there, value,
                 [&] { return schema::Percent(violations_, path_.Field(name), value); });
  }
  /// Degrees, as the same angle above -180 and up to 180.
  [[nodiscard]] std::optional<float> Angle(std::string_view name, bool there, float value) {
    const std::optional<float> angle = Finite(name, there, value);
    if (!angle) return std::nullopt;
    const double turned = schema::NormalizedHeading(static_cast<double>(*angle));
    return static_cast<float>(turned > kHalfTurnDeg ? turned - 2 * kHalfTurnDeg : turned);
  }

  template <model::OpenEnum E, typename Theirs>
  [[nodiscard]] E Enum(Theirs number) {
    const E value{static_cast<std::int32_t>(number)};
    if (!model::IsRecognized(value)) violations_.CountUnrecognized();
    return value;
  }

  /// Empty if it is invalid, too.
  [[nodiscard]] std::string Text(std::string_view name, std::string_view text,
                                 std::size_t bytes_max) {
    return schema::Text(violations_, path_.Field(name), text, bytes_max).value_or(std::string());
  }
  /// Of a durable type: must not be empty.
  [[nodiscard]] std::string RequiredText(std::string_view name, std::string_view text,
                                         std::size_t bytes_max) {
    return schema::RequiredText(violations_, path_.Field(name), text, bytes_max);
  }

  /// A time of the drone's clock in Unix microseconds; 0 if it is negative or from 2100 on.
  [[nodiscard]] std::int64_t TimeUs(std::int64_t unix_us) {
    if (unix_us >= 0 && unix_us < schema::kTimeMsEnd * 1000) return unix_us;
    violations_.CountUnknownTime();
    return 0;
  }

  /// What `read(in)` makes of a struct within this one; nothing if it is absent or says nothing.
  template <typename Read>
  [[nodiscard]] auto Within(std::string_view name, bool there, Read read)
      -> std::optional<std::invoke_result_t<Read, Reader&>> {
    if (!there) return std::nullopt;
    const schema::Path path = path_.Field(name);
    Reader in(violations_, path);
    auto body = read(in);
    if (!IsKnown(body)) return std::nullopt;
    return body;
  }

  /// Where a violation of a rule of several fields stands.
  [[nodiscard]] schema::Violations& violations() { return violations_; }
  [[nodiscard]] const schema::Path& path() const { return path_; }

 private:
  static constexpr double kHalfTurnDeg = 180;

  template <typename T, typename Rule>
  [[nodiscard]] static std::optional<T> Known(bool there, T value, Rule rule) {
    if (!there) return std::nullopt;
    if constexpr (std::is_floating_point_v<T>) {
      if (std::isnan(value)) return std::nullopt;
    }
    return rule();
  }

  schema::Violations& violations_;
  const schema::Path& path_;
};

}  // namespace uplink::uncrew
