#include "schema/model/variants.h"

#include <array>

namespace uplink::model {
namespace {

#define UPLINK_VARIANT(Member, name, Body, settling) Settling::settling,
constexpr std::array<Settling, kVariants> kSettling = {UPLINK_VARIANTS(UPLINK_VARIANT)};
#undef UPLINK_VARIANT

}  // namespace

std::string_view ToText(Variant variant) {
  switch (variant) {
#define UPLINK_VARIANT(Member, name, Body, settling) \
  case Variant::k##Member:                           \
    return name;
    UPLINK_VARIANTS(UPLINK_VARIANT)
#undef UPLINK_VARIANT
  }
  return "unknown";
}

bool IsDurable(Variant variant) {
  return kSettling[static_cast<std::size_t>(variant)] == Settling::kDurable;
}

}  // namespace uplink::model
