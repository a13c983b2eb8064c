#include "server/view/parts.h"

#include <algorithm>
#include <array>

#include "server/robot/live_parts.h"

namespace uplink::view {
namespace {

/// By Part: the JSON name of its field in v1::Robot.
constexpr std::array<std::string_view, kParts> kNames = {"agentInfo", "settings", "uiCapabilities",
#define UPLINK_PART(Part, column, view, Message, keys_max) view,
                                                         UPLINK_LIVE_PARTS(UPLINK_PART)
#undef UPLINK_PART
                                                             "cyberwave"};

}  // namespace

bool PartSet::AnyOf(std::size_t first, std::size_t count) const {
  for (std::size_t i = first; i < first + count; ++i) {
    if (bits_.test(i)) return true;
  }
  return false;
}

bool PartSet::AnyStored() const { return AnyOf(0, storage::kLatestKinds); }

bool PartSet::AnyLive() const { return AnyOf(storage::kLatestKinds, storage::kLivePartKinds); }

bool PartSet::AnyLarge() const {
  bool any = false;
  robot::ForEachPart([&]<typename Tag>(Tag /*row*/) {
    if constexpr (!Tag::kSmall) any = any || Has(ToPart(Tag::kLivePart));
  });
  return any;
}

std::optional<Part> PartFromText(std::string_view text) {
  const auto* const name = std::ranges::find(kNames, text);
  if (name == kNames.end()) return std::nullopt;
  return static_cast<Part>(name - kNames.begin());
}

}  // namespace uplink::view
