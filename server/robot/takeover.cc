#include "server/robot/takeover.h"

#include <utility>

namespace uplink::robot {

Takeover::Attached Takeover::Attach(loop::StreamRef stream, SteadyTime now, SystemTime system_now,
                                    std::string gateway) {
  Attached attached;
  if (!current_) {
    current_ = stream;
    current_standing_ = Standing::kCurrent;
    connected_since_ = system_now;
    gateway_ = std::move(gateway);
    return attached;
  }
  attached.standing = Standing::kWaiting;
  attached.took_over = true;
  attached.contested = AddTakeover(now);
  attached.to_wake.push_back(current_);
  if (next_) attached.to_wake.push_back(next_);
  current_standing_ = Standing::kSuperseded;
  next_ = stream;
  next_since_ = system_now;
  next_gateway_ = std::move(gateway);
  return attached;
}

bool Takeover::AddTakeover(SteadyTime now) {
  takeovers_.Note(now);
  const bool was = contested_;
  Sweep(now);
  return contested_ && !was;
}

Standing Takeover::StandingOf(loop::StreamRef stream) const {
  if (stream == current_) return current_standing_;
  return stream == next_ ? Standing::kWaiting : Standing::kSuperseded;
}

loop::StreamRef Takeover::Detach(loop::StreamRef stream) {
  if (stream == next_) {
    next_ = {};
    next_gateway_.clear();
    return {};
  }
  if (stream != current_) return {};
  current_ = std::exchange(next_, {});
  current_standing_ = Standing::kCurrent;
  if (!current_) return {};
  connected_since_ = next_since_;
  gateway_ = std::exchange(next_gateway_, {});
  return current_;
}

void Takeover::Stop(Standing standing) {
  if (current_) current_standing_ = standing;
}

void Takeover::Refuse(loop::StreamRef stream) {
  if (current_ && current_ == stream) current_standing_ = Standing::kOtherFleet;
}

void Takeover::End(Standing standing) {
  if (current_ && current_standing_ == Standing::kCurrent) current_standing_ = standing;
}

void Takeover::Sweep(SteadyTime now) { contested_ = takeovers_.IsFull(now, kMinute); }

}  // namespace uplink::robot
