#include "server/robot/held_back.h"

namespace uplink::robot {

std::string_view ToText(HeldBack by) {
  switch (by) {
    case HeldBack::kNone:
      return "";
    case HeldBack::kInFlight:
      return "in_flight";
    case HeldBack::kJournal:
      return "journal";
    case HeldBack::kUnread:
      return "unread";
    case HeldBack::kMalformed:
      return "malformed";
  }
  return "";
}

}  // namespace uplink::robot
