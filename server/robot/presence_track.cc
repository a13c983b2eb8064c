#include "server/robot/presence_track.h"

#include <algorithm>
#include <utility>

#include "server/robot/mutation.h"

namespace uplink::robot {
namespace {

/// Unknown is the server's doing, and no change of the robot's.
bool CrossesOffline(Presence from, Presence to) {
  return (from == Presence::kOnline && to == Presence::kOffline) ||
         (from == Presence::kOffline && to == Presence::kOnline);
}

}  // namespace

void PresenceTrack::BeginListening(SteadyTime now) {
  server_started_ = now;
  known_since_ = std::max(known_since_, now);
}

PresenceTrack::Sign PresenceTrack::AddSign(SteadyTime steady, SystemTime system,
                                           const PresenceLimits& limits) {
  if (foreign_) return Sign::kOlder;
  Sign sign = Sign::kOlder;
  const bool came_back = parking_.AddSign(steady);
  if (presence_ == Presence::kOffline && stall_while_offline_) {
    held_back_until_ = std::max(held_back_until_, std::exchange(stall_while_offline_, {}));
  }
  if (!last_sign_ || steady >= *last_sign_) {
    last_sign_ = steady;
    online_until_ = steady + limits.timeout;
    last_sign_system_ = system;
    claimed_.reset();
    offline_since_.reset();
    sign = Sign::kLatest;
  }
  Reach(steady, system);
  const Presence before = presence_;
  Update(limits);
  if (came_back && presence_ == before) Tell();
  return sign;
}

void PresenceTrack::Park(SystemTime until, SteadyTime signs_count_from, SteadyTime now) {
  if (foreign_) return;
  parking_.Begin(until, signs_count_from);
  parking_said_ = now;
  Tell();
}

void PresenceTrack::SweepAround(SteadyTime steady, SystemTime system,
                                const PresenceLimits& limits) {
  Reach(steady, system);
  parking_.Reach({steady, system}, limits.parked_max);
  flaps_.Reach(steady, limits.flaps);
}

void PresenceTrack::SetReading(Reading reading, SteadyTime now) {
  const bool held_back = reading == Reading::kHeldBack;
  if (held_back_ && !held_back) {
    stream_held_back_until_ = now;
    held_back_until_ = std::max(held_back_until_.value_or(now), now);
  }
  held_back_ = held_back;
}

void PresenceTrack::AddStall(SteadyTime until) {
  auto& stall = presence_ == Presence::kOffline ? stall_while_offline_ : held_back_until_;
  stall = std::max(stall.value_or(until), until);
}

void PresenceTrack::NoteReplaced(const Replaced& replaced) {
  const bool doubtful = !foreign_ && presence_ == Presence::kOffline && judged_offline_ &&
                        *judged_offline_ >= replaced.doubted;
  // Before the stall, which waits for a sign of life while the robot is offline.
  if (doubtful) Change(Presence::kUnknown, replaced.system_now);
  AddStall(replaced.until);
}

SteadyTime PresenceTrack::AnswerCountsFrom(const PresenceLimits& limits) const {
  const SteadyTime from = NotOfflineUntil(Facts(), limits);
  return stream_began_ ? std::max(from, *stream_began_ + limits.timeout) : from;
}

bool PresenceTrack::AskBeforeOffline(SteadyTime now, const PresenceLimits& limits) {
  if (presence_ == Presence::kOffline || foreign_ || held_back_) return false;
  if (now < NotOfflineUntil(Facts(), limits)) return false;
  const SteadyTime counts_from = AnswerCountsFrom(limits);
  if (peer_answered_ && *peer_answered_ >= counts_from) return false;
  unanswered_until_ = now;
  return now >= counts_from;
}

void PresenceTrack::NotePeerAnswered(SteadyTime now, const PresenceLimits& limits) {
  peer_answered_ = now;
  if (now >= AnswerCountsFrom(limits)) unanswered_until_.reset();
}

void PresenceTrack::ForgetSigns(SteadyTime unknown_until, SystemTime system_now) {
  if (foreign_ || presence_ != Presence::kOnline) return;
  last_sign_.reset();
  peer_answered_.reset();
  claimed_.reset();
  unknown_until_ = unknown_until;
  Change(Presence::kUnknown, system_now);
}

Presence PresenceTrack::Sweep(SteadyTime steady, SystemTime system, const PresenceLimits& limits) {
  Reach(steady, system);
  Update(limits);
  return presence_;
}

void PresenceTrack::Restore(std::optional<SystemTime> last_sign) {
  if (!last_sign_system_) last_sign_system_ = last_sign;
}

void PresenceTrack::Claim(const storage::StoredPresence& stored, SteadyTime now) {
  foreign_ = false;
  known_since_ = now;
  FollowParking(stored);
  if (!HeardInTime(now)) {
    BeginFrom(stored);
    claimed_ = {stored.presence, now};
  } else {
    GoOnFrom(stored);
    // The stream here may be the rest of one that the robot gave up to go there.
    if (stored.presence == Presence::kOnline) claimed_ = {stored.presence, now};
  }
  if (parking_.until() != stored.parked_until) Tell();
}

void PresenceTrack::FollowParking(const storage::StoredPresence& stored) {
  const SteadyTime stream = stream_began_.value_or(SteadyTime::max());
  const bool said_here = parking_said_ && *parking_said_ >= stream;
  const bool heard_here = last_sign_ && *last_sign_ >= stream;
  if (!said_here && !heard_here) parking_.Follow(stored.parked_until);
}

bool PresenceTrack::HeardInTime(SteadyTime now) const { return last_sign_ && now <= online_until_; }

void PresenceTrack::GoOnFrom(const storage::StoredPresence& stored) {
  held_back_until_ = std::max(held_back_until_, std::exchange(stall_while_offline_, {}));
  if (stored.presence == Presence::kOnline) {
    presence_ = stored.presence;
    since_ = stored.since;
  } else {
    // It was reported before, but was not written before the store named the robot's holder.
    Change(Presence::kOnline, std::max(since_, stored.since));
  }
}

void PresenceTrack::BeginFrom(const storage::StoredPresence& stored) {
  last_sign_.reset();
  claimed_.reset();
  unknown_until_.reset();
  offline_since_.reset();
  presence_ = stored.presence;
  since_ = stored.since;
  // A stall depends on the robot's presence now: an offline robot stays so until it is heard.
  const auto stalled_until =
      std::max(std::exchange(held_back_until_, {}), std::exchange(stall_while_offline_, {}));
  (presence_ == Presence::kOffline ? stall_while_offline_ : held_back_until_) = stalled_until;
}

void PresenceTrack::Adopt(const Adoption& adoption) {
  foreign_ = false;
  known_since_ = adoption.now;
  parking_.Follow(adoption.stored.parked_until);
  if (HeardInTime(adoption.now)) {
    GoOnFrom(adoption.stored);
    // Its holder may have heard it later than we did.
    if (adoption.stored.presence == Presence::kOnline) claimed_ = {Presence::kOnline, adoption.now};
    return;
  }
  BeginFrom(adoption.stored);
  const bool was_offline = presence_ == Presence::kOffline && !Planted(Mutation::kOfflineForgotten);
  if (was_offline && adoption.end == storage::HolderEnd::kEnded) {
    claimed_ = {presence_, adoption.now};
    return;
  }
  unknown_until_ = adoption.unknown_until;
  if (was_offline) {
    offline_since_ = since_;
    Show(Presence::kUnknown, adoption.system_now);
  } else if (presence_ != Presence::kUnknown) {
    Change(Presence::kUnknown, adoption.system_now);
  }
}

void PresenceTrack::Follow(const storage::StoredPresence& stored) {
  foreign_ = true;
  last_sign_system_.reset();
  held_back_ = false;
  stream_held_back_until_.reset();
  unanswered_until_.reset();
  // If the robot is ours again at once, signs of life heard here stay valid.
  const std::optional<SteadyTime> heard = last_sign_;
  if (CrossesOffline(presence_, stored.presence)) flaps_.Add(reached_.value_or(server_started_));
  parking_.Follow(stored.parked_until);
  BeginFrom(stored);
  last_sign_ = heard;
}

void PresenceTrack::Show(Presence presence, SystemTime since) {
  presence_ = presence;
  since_ = since;
}

void PresenceTrack::Change(Presence presence, SystemTime at) {
  if (CrossesOffline(presence_, presence)) flaps_.Add(reached_.value_or(server_started_));
  Show(presence, at);
  Tell();
}

void PresenceTrack::Tell() const {
  if (changed_) changed_(now());
}

void PresenceTrack::Reach(SteadyTime steady, SystemTime system) {
  if (reached_ && steady <= *reached_) return;
  reached_ = steady;
  reached_system_ = system;
}

PresenceFacts PresenceTrack::Facts() const {
  return {.now = reached_.value_or(server_started_),
          .server_started = server_started_,
          .known_since = known_since_,
          .last_sign_of_life = last_sign_,
          .held_back = held_back_,
          .held_back_until = held_back_until_,
          .claimed = claimed_,
          .unknown_until = unknown_until_};
}

void PresenceTrack::Update(const PresenceLimits& limits) {
  if (foreign_) return;
  PresenceFacts facts = Facts();
  facts.held_back_until = std::max(facts.held_back_until, unanswered_until_);
  const Presence presence = PresenceOf(facts, limits);
  if (presence == presence_) return;
  if (presence == Presence::kOffline && offline_since_) return Show(presence, *offline_since_);
  if (presence == Presence::kOffline) judged_offline_ = reached_;
  Change(presence, reached_system_);
}

}  // namespace uplink::robot
