#include "server/robot/held_back.h"

namespace uplink::robot {

std::string_view ToText(HeldBack by) {
  switch (by) {
    case HeldBack::kNone:
      return "";
    case HeldBack::kInFlight:
      return "in_flight";
    case HeldBack::kJournalShare:
      return "journal_share";
    case HeldBack::kJournal:
      return "journal";
    case HeldBack::kFlow:
      return "flow";
    case HeldBack::kDisk:
      return "disk";
    case HeldBack::kUnread:
      return "unread";
    case HeldBack::kMalformed:
      return "malformed";
  }
  return "";
}

void HeldBackTrack::Set(HeldBack by, SystemTime now) {
  if (by == HeldBack::kNone) {
    let_go_at_ = now;
  } else if (by_ == HeldBack::kNone && now - let_go_at_ > kHeldBackAgain) {
    since_ = now;
  }
  by_ = by;
}

}  // namespace uplink::robot
