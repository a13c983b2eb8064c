// What bytes of a frame that is not whole yet are worth.
#include "server/robot/mutation.h"
#include "server/session/session.h"

namespace uplink::session {

void Session::OnFrameBytes() {
  if (state_ != State::kStreaming) return;
  const bool counts = slow_frame_.Add(context_.clock.Steady());
  if (!counts && !robot::Planted(robot::Mutation::kSlowFrameUnbounded)) return;
  robot_.robot().state.SignOfLife(context_.clock.Steady(), context_.clock.System(),
                                  presence_limits());
}

}  // namespace uplink::session
