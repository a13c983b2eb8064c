#pragma once

#include <cstddef>
#include <cstdint>

#include "schema/model/ids.h"
#include "server/robot/robot_sessions.h"

namespace uplink::session {

/// The numbers of a stream while its messages are processed. It locks the robot's sessions as
/// seldom as the order of the numbers allows.
///
/// Thread: confined to the stream's thread.
class NumberRun final {
 public:
  /// `sessions` outlives it.
  NumberRun(robot::RobotSessions& sessions, const model::SessionId& session)
      : sessions_(sessions), session_(session) {}

  /// A pass over messages begins: the robot may have been taken over since the last one.
  void Begin() { new_before_ = 0; }
  /// Sees a number, as robot::RobotSessions::See. A number directly after a new one is new.
  [[nodiscard]] robot::Seen See(model::Seq seq);
  /// The number just seen is settled; the sessions learn it by Flush at the latest.
  void AddSettled(model::Seq seq) { unsettled_ = seq; }
  /// The number just seen waits for its commit, as robot::RobotSessions::AddWaiting.
  [[nodiscard]] std::int64_t AddWaiting(model::Seq seq, std::size_t bytes);
  /// The number just seen is not taken now, and will be seen again.
  void PutBack() { new_before_ = 0; }
  /// Tells the sessions what is settled. Ends a pass.
  void Flush();

 private:
  robot::RobotSessions& sessions_;
  const model::SessionId session_;
  /// The previous number, if it was new; otherwise 0.
  model::Seq new_before_ = 0;
  /// The highest settled number that the sessions were not told; 0 if there is none.
  model::Seq unsettled_ = 0;
};

}  // namespace uplink::session
