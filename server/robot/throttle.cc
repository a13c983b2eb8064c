#include "server/robot/throttle.h"

#include "server/robot/limits.h"

namespace uplink::robot {
namespace {

constexpr limits::BucketSize kRejects =
    limits::PolicyOf(limits::PolicyId::kRejectsOfRobot).bucket();

}  // namespace

void Throttle::Add(SteadyTime now) {
  if (end_ && now >= *end_) end_.reset();
  bucket_.Take(1, kRejects, now);
  // At the bound the bucket is empty, past it negative.
  if (end_ || bucket_.PassesAt(0, kRejects, now) <= now) return;
  end_ = bucket_.PassesAt(kRejectsAtOnce, kRejects, now);
}

}  // namespace uplink::robot
