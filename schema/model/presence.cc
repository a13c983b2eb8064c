#include "schema/model/presence.h"

#include "schema/base/check.h"

namespace uplink::model {

std::string_view ToText(Presence presence) {
  switch (presence) {
    case Presence::kUnknown:
      return "unknown";
    case Presence::kOnline:
      return "online";
    case Presence::kOffline:
      return "offline";
  }
  CheckFailed(__FILE__, __LINE__, "presence", "a presence that does not exist");
}

std::optional<Presence> PresenceFromText(std::string_view text) {
  for (const Presence presence : {Presence::kUnknown, Presence::kOnline, Presence::kOffline}) {
    if (ToText(presence) == text) return presence;
  }
  return std::nullopt;
}

}  // namespace uplink::model
