#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "schema/model/capabilities.h"
#include "schema/model/extras.h"
#include "schema/model/health.h"
#include "schema/model/mission.h"
#include "schema/model/motion.h"
#include "schema/model/rejection.h"
#include "schema/model/reports.h"
#include "schema/model/spatial.h"
#include "schema/model/status.h"
#include "schema/model/variants.h"

namespace uplink::schema {
class Judge;
}
namespace uplink::cyberwave {
class Records;
}
namespace uplink::uncrew {
class Records;
}

namespace uplink::model {

/// The variant of all but the first: rows bring a comma each in front.
template <typename /*none*/, typename... Bodies>
using VariantOfRows = std::variant<Bodies...>;

#define UPLINK_VARIANT(Member, name, Body, settling) , Body
using Body = VariantOfRows<void UPLINK_VARIANTS(UPLINK_VARIANT)>;
#undef UPLINK_VARIANT

static_assert(std::variant_size_v<Body> == kVariants);

/// How the kind of a body's alternative is settled: `kSettling`.
template <typename Alternative>
struct SettlingOf;
#define UPLINK_VARIANT(Member, name, Body, settling)          \
  template <>                                                 \
  struct SettlingOf<Body> {                                   \
    static constexpr Settling kSettling = Settling::settling; \
  };
UPLINK_VARIANTS(UPLINK_VARIANT)
#undef UPLINK_VARIANT

[[nodiscard]] inline Variant VariantOf(const Body& body) {
  return static_cast<Variant>(body.index());
}

/// When a message was sampled by its robot's clock, Unix milliseconds; 0: it does not say.
[[nodiscard]] std::int64_t SampledUnixMs(const Body& body);

/// A validated message. Only a passing judgement makes one (schema::Judge, and the Records of
/// cyberwave and uncrew), so a Record need not be checked again. A value.
class Record {
 public:
  [[nodiscard]] Variant variant() const { return VariantOf(body_); }
  [[nodiscard]] bool durable() const { return IsDurable(variant()); }
  [[nodiscard]] const Body& body() const { return body_; }
  /// Moves the body out; the record must not be used afterwards.
  [[nodiscard]] Body&& TakeBody() && { return std::move(body_); }
  /// What judgement dropped, the first of it (schema::kDroppedFieldsListedMax); always empty for
  /// durable kinds.
  [[nodiscard]] std::span<const DroppedField> dropped() const { return dropped_; }
  /// What it dropped beyond that, by reason.
  [[nodiscard]] std::span<const UnlistedFields> unlisted() const { return unlisted_; }
  /// Size of the serialized payload it came from.
  [[nodiscard]] std::size_t payload_bytes() const { return payload_bytes_; }

 private:
  friend class uplink::schema::Judge;
  friend class uplink::cyberwave::Records;
  friend class uplink::uncrew::Records;
  Record(Body body, std::vector<DroppedField> dropped, std::vector<UnlistedFields> unlisted,
         std::size_t payload_bytes);

  Body body_;
  std::vector<DroppedField> dropped_;
  std::vector<UnlistedFields> unlisted_;
  std::size_t payload_bytes_ = 0;
};

}  // namespace uplink::model
