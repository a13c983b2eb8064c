#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "schema/model/uncrew/devices.h"
#include "schema/model/uncrew/modes.h"
#include "schema/model/uncrew/motion.h"
#include "schema/model/uncrew/reports.h"
#include "schema/model/uncrew/types.h"

namespace uplink::model::uncrew {

/// The variant of all but the first: rows bring a comma each in front.
template <typename /*none*/, typename... Values>
using VariantOfRows = std::variant<Values...>;

#define UPLINK_TYPE(Type, Method, member, name, kind, parts_max) , Type
/// What a sample says; the alternatives stand in the order of the types.
using Value = VariantOfRows<void UPLINK_UNCREW_TYPES(UPLINK_TYPE)>;
#undef UPLINK_TYPE

/// The kind of the row of a value's struct.
template <typename Body>
inline constexpr SampleKind kKindOf = SampleKind::kLive;
#define UPLINK_TYPE(Type, Method, member, name, kind, parts_max) \
  template <>                                                    \
  inline constexpr SampleKind kKindOf<Type> = SampleKind::kind;
UPLINK_UNCREW_TYPES(UPLINK_TYPE)
#undef UPLINK_TYPE

[[nodiscard]] inline SampleType TypeOf(const Value& value) {
  return static_cast<SampleType>(value.index() + 1);
}

/// By which key a drone has several of it; nothing for types without.
[[nodiscard]] inline std::optional<std::int64_t> KeyOf(const Value& value) {
  return std::visit(
      [](const auto& body) -> std::optional<std::int64_t> {
        if constexpr (requires { body.key; }) return body.key;
        return std::nullopt;
      },
      value);
}

/// Whose a sample is and when it was taken, as the drone says. A value.
struct Metadata {
  /// As it came, by no rule; empty: the drone of the certificate.
  std::string uav_id;
  /// Unix microseconds by the drone's clock; 0: unknown.
  std::int64_t sampled_at_us = 0;
  /// Microseconds since the drone started; 0: unknown.
  std::uint64_t boot_us = 0;

  /// Whether a time tells two samples of the same content apart.
  [[nodiscard]] bool timed() const { return sampled_at_us != 0 || boot_us != 0; }

  friend bool operator==(const Metadata&, const Metadata&) = default;
};

}  // namespace uplink::model::uncrew
