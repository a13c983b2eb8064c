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
};

}  // namespace

bool PartSet::AnyStored() const { return (bits_ << storage::kLivePartKinds).any(); }

bool PartSet::AnyLive() const { return (bits_ >> storage::kLatestKinds).any(); }

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
