#include "tools/uplink-fleet/compare/findings.h"

#include <utility>

namespace uplink::synthetic {
namespace {

/// How the last of a live part is named.
std::string_view LastOf(Thing thing, std::string_view name) {
  return thing == Thing::kRcan ? "last RCAN states" : name;
}

}  // namespace

ThingText TextOf(Thing thing) {
  switch (thing) {
    case Thing::kOnline:
      return {"robots online", false};
    case Thing::kPresenceHistory:
      return {"presence histories", true};
#define UPLINK_PART(Part, column, view, Message, keys_max) \
  case Thing::k##Part:                                     \
    return {LastOf(Thing::k##Part, "last " #column), false};
      UPLINK_LIVE_PARTS(UPLINK_PART)
#undef UPLINK_PART
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
    case Thing::kForwardedItems:
      return {"forwarded items", false};
    case Thing::kForwardViolations:
      return {"forward violations", false};
    case Thing::kTwinOnline:
      return {"twins' robots online, by source", false};
    case Thing::kTwinPresence:
      return {"presence histories", true};
    case Thing::kTwinLive:
      return {"last live values", false};
    case Thing::kTwinSecrets:
      return {"answers without a secret", false};
    case Thing::kTwinSessions:
      return {"sessions", false};
    case Thing::kTwinEvents:
      return {"events", true};
    case Thing::kTwinMessages:
      return {"log lines", true};
    case Thing::kTwinRuns:
      return {"mission runs", true};
    case Thing::kTwinRunUpdates:
      return {"mission updates", true};
    case Thing::kTwinFaults:
      return {"errors raised and cleared", true};
    case Thing::kTwinActiveFaults:
      return {"active errors", true};
    case Thing::kTwinScopes:
      return {"environments and workflow runs", true};
    case Thing::kTwinQuarantine:
      return {"wrong on purpose, in quarantine", true};
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
