#include "server/robot/parking.h"

#include <algorithm>

namespace uplink::robot {

void Parking::Begin(SystemTime until, SteadyTime signs_count_from) {
  until_ = until;
  deadline_.reset();
  signs_count_from_ = signs_count_from;
  over_ = false;
}

void Parking::EndStream(SteadyTime now) { signs_count_from_ = std::min(signs_count_from_, now); }

void Parking::Follow(std::optional<SystemTime> until) {
  signs_count_from_ = SteadyTime::min();
  // Its holder does not write that its time has come: it stays over here.
  if (until == until_) return;
  until_ = until;
  deadline_.reset();
  over_ = false;
}

bool Parking::AddSign(SteadyTime at) {
  if (!until() || at < signs_count_from_) return false;
  until_.reset();
  return true;
}

void Parking::Reach(Now now, milliseconds max) {
  if (!until() || over_) return;
  const SystemTime::duration left = *until_ - now.system;
  if (!deadline_) deadline_ = now.steady + std::min<SystemTime::duration>(left, max);
  over_ = left <= SystemTime::duration::zero() || now.steady >= *deadline_;
}

std::optional<SystemTime> Parking::until() const { return over_ ? std::nullopt : until_; }

}  // namespace uplink::robot
