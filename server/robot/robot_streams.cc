// Which stream is the robot's: attaching, taking over, detaching.
#include <utility>

#include "server/robot/robot_sessions.h"

namespace uplink::robot {

RobotSessions::Attached RobotSessions::Attach(StreamRef stream, SteadyTime now,
                                              SystemTime system_now) {
  const std::lock_guard lock(mutex_);
  Attached attached;
  if (!current_) {
    current_ = stream;
    current_superseded_ = false;
    connected_since_ = system_now;
    return attached;
  }
  attached.place = StreamPlace::kWaiting;
  attached.took_over = true;
  attached.contested = NoteTakeover(now);
  attached.to_wake.push_back(current_);
  if (next_) attached.to_wake.push_back(next_);
  current_superseded_ = true;
  next_ = stream;
  next_since_ = system_now;
  return attached;
}

bool RobotSessions::NoteTakeover(SteadyTime now) {
  takeovers_.push_back(now);
  // Only whether there were more than the limit counts, so no more need be kept.
  while (takeovers_.size() > kTakeoversPerMinuteMax + 1 ||
         now - takeovers_.front() > std::chrono::minutes(1)) {
    takeovers_.pop_front();
  }
  const bool was = contested_;
  contested_ = takeovers_.size() > kTakeoversPerMinuteMax;
  return contested_ && !was;
}

StreamPlace RobotSessions::PlaceOf(StreamRef stream) const {
  const std::lock_guard lock(mutex_);
  if (stream == current_) {
    return current_superseded_ ? StreamPlace::kSuperseded : StreamPlace::kCurrent;
  }
  return stream == next_ ? StreamPlace::kWaiting : StreamPlace::kSuperseded;
}

StreamRef RobotSessions::Detach(StreamRef stream, SteadyTime now) {
  const std::lock_guard lock(mutex_);
  if (stream == next_) {
    next_ = {};
    return {};
  }
  if (stream != current_) return {};
  if (current_session_) {
    if (Numbering* numbering = Find(*current_session_)) {
      numbering->last_used = now;
      numbering->released.clear();
    }
  }
  current_ = std::exchange(next_, {});
  current_superseded_ = false;
  if (current_) connected_since_ = next_since_;
  return current_;
}

}  // namespace uplink::robot
