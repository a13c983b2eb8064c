#include "server/robot/presence_track.h"

namespace uplink::robot {

PresenceTrack::Sign PresenceTrack::AddSign(SteadyTime steady, SystemTime system,
                                           const PresenceLimits& limits) {
  Sign sign = Sign::kOlder;
  if (!last_sign_ || steady >= *last_sign_) {
    last_sign_ = steady;
    last_sign_system_ = system;
    sign = Sign::kLatest;
  }
  Reach(steady, system);
  Update(limits);
  return sign;
}

void PresenceTrack::SetReading(Reading reading, SteadyTime now) {
  const bool held_back = reading == Reading::kHeldBack;
  if (held_back_ && !held_back) held_back_until_ = stream_held_back_until_ = now;
  held_back_ = held_back;
}

void PresenceTrack::AddStall(SteadyTime now) {
  if (presence_ != Presence::kOffline) held_back_until_ = now;
}

Presence PresenceTrack::Sweep(SteadyTime steady, SystemTime system, const PresenceLimits& limits) {
  Reach(steady, system);
  Update(limits);
  return presence_;
}

void PresenceTrack::Restore(std::optional<SystemTime> last_sign) {
  if (!last_sign_system_) last_sign_system_ = last_sign;
}

void PresenceTrack::Reach(SteadyTime steady, SystemTime system) {
  if (reached_ && steady <= *reached_) return;
  reached_ = steady;
  reached_system_ = system;
}

void PresenceTrack::Update(const PresenceLimits& limits) {
  const Presence presence = PresenceOf({.now = reached_.value_or(server_started_),
                                        .server_started = server_started_,
                                        .known_since = known_since_,
                                        .last_sign_of_life = last_sign_,
                                        .held_back = held_back_,
                                        .held_back_until = held_back_until_},
                                       limits);
  if (presence == presence_) return;
  presence_ = presence;
  since_ = reached_system_;
  if (changed_) changed_(presence, since_);
}

}  // namespace uplink::robot
