#include "server/session/number_run.h"

#include <utility>

namespace uplink::session {

robot::Seen NumberRun::See(model::Seq seq) {
  // The numbers of a batch increase, so a number after a new one is new, and directly after it none
  // is missing: no lookup is needed.
  if (new_before_ > 0 && seq == new_before_ + 1) {
    new_before_ = seq;
    return {};
  }
  Flush();
  const robot::Seen seen = sessions_.See(session_, seq);
  new_before_ = seen.as == robot::SeenAs::kNew ? seq : 0;
  return seen;
}

std::int64_t NumberRun::AddWaiting(model::Seq seq, std::size_t bytes) {
  Flush();
  const std::int64_t grew = sessions_.AddWaiting(session_, seq, bytes);
  // Another process has taken the robot since the number was seen: the next look says so.
  if (grew == 0) new_before_ = 0;
  return grew;
}

void NumberRun::Flush() {
  if (unsettled_ == 0) return;
  sessions_.AddSettled(session_, std::exchange(unsettled_, 0));
}

}  // namespace uplink::session
