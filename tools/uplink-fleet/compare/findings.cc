#include "tools/uplink-fleet/compare/findings.h"

#include <utility>

namespace uplink::synthetic {

ThingText TextOf(Thing thing) {
  switch (thing) {
    case Thing::kOnline:
      return {"robots online", false};
    case Thing::kPresenceHistory:
      return {"presence histories", true};
    case Thing::kMotion:
      return {"last motion", false};
    case Thing::kStatus:
      return {"last status", false};
    case Thing::kExtras:
      return {"last extras", false};
    case Thing::kHealth:
      return {"last health", false};
    case Thing::kUsage:
      return {"last usage", false};
    case Thing::kConsumables:
      return {"last consumables", false};
    case Thing::kDirectives:
      return {"last directives", false};
    case Thing::kRcanState:
      return {"last RCAN states", false};
    case Thing::kAgentInfo:
      return {"latest agent info", true};
    case Thing::kSettings:
      return {"latest settings", true};
    case Thing::kUiCapabilities:
      return {"latest UI capabilities", true};
    case Thing::kNumbersMissing:
      return {"numbers missing", false};
    case Thing::kFaultReports:
      return {"fault reports", true};
    case Thing::kActiveFaults:
      return {"active faults", true};
    case Thing::kEvents:
      return {"events", true};
    case Thing::kMessages:
      return {"messages for people", true};
    case Thing::kMissionRuns:
      return {"mission runs", true};
    case Thing::kMissionUpdates:
      return {"mission updates", true};
    case Thing::kShapes:
      return {"shapes present", true};
    case Thing::kObjects:
      return {"objects present", true};
    case Thing::kQuarantine:
      return {"wrong on purpose, in quarantine", true};
    case Thing::kToldBeforeAck:
      return {"wrong on purpose, told before the ack", false};
    case Thing::kGaps:
      return {"gaps", true};
    case Thing::kGoodRejected:
      return {"good messages rejected", false};
  }
  return {"", false};
}

void Findings::Differ(Thing thing, const std::string& ruri, std::string expected,
                      std::string found) {
  ++At(thing).differences;
  if (differences_.size() >= kDifferencesMax) return;
  differences_.push_back({ruri, thing, std::move(expected), std::move(found)});
}

std::uint64_t Findings::differences_in_all() const {
  std::uint64_t sum = 0;
  for (const Tally& tally : tallies_) sum += tally.differences;
  return sum;
}

}  // namespace uplink::synthetic
