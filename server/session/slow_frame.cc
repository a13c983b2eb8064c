#include "server/session/slow_frame.h"

#include "server/robot/mutation.h"

namespace uplink::session {

bool SlowFrame::Add(SteadyTime now) {
  if (!began_) began_ = now;
  return now - *began_ <= kSlowFrameMax || robot::Planted(robot::Mutation::kSlowFrameUnbounded);
}

}  // namespace uplink::session
