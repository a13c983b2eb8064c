#pragma once

#include <string>

#include "tools/uplink-fleet/twin/speech.h"

namespace uplink::synthetic {

/// A twin's joints, in the three formats; a follower beside its leader, a simulation, and what is
/// only wanted. Thread: confined to one thread.
class JointUpdates final {
 public:
  explicit JointUpdates(const Speech& speech) : speech_(speech) {}

  /// `joint_name` and `joint_state`, all three channels.
  [[nodiscard]] Publication Single();
  /// The same with its position alone: the other channels stay as they were.
  [[nodiscard]] Publication SinglePosition();
  /// `positions`, `velocities`, `efforts`, by a follower and by its leader, whose joints have the
  /// same names.
  [[nodiscard]] Publication Follower();
  [[nodiscard]] Publication Leader();
  [[nodiscard]] Publication Simulated();
  /// Names and numbers, without a time.
  [[nodiscard]] Publication Flat();
  /// On the topic joint_states.
  [[nodiscard]] Publication States();
  /// Targets beside nothing, and joints of a teleoperator: counted alone.
  [[nodiscard]] Publication Setpoints();
  [[nodiscard]] Publication Teleoperated();

 private:
  void Channel(Side side, const std::string& group, const std::string& joint, const char* channel,
               double value);
  void Time(Side side, const std::string& group, const std::string& joint, const Draft& draft);
  [[nodiscard]] double Angle();
  [[nodiscard]] Publication Maps(Side side, Speaker speaker, const std::string& group);

  Speech speech_;
};

}  // namespace uplink::synthetic
