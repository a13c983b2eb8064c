#include "server/store/space_judge.h"

#include <algorithm>

namespace uplink::store {
namespace {

/// Whether less is free than a bound of `halves` halves of free_min. A bound that was passed is
/// released at 6/5 of it.
bool Passed(const SpaceFacts& facts, std::uint64_t halves, bool before) {
  const std::uint64_t bound = facts.free_min * halves;
  return before ? facts.free_bytes * 10 < bound * 6 : facts.free_bytes * 2 < bound;
}

}  // namespace

std::uint64_t FreeMinOf(std::uint64_t configured, std::uint64_t total_bytes) {
  const std::uint64_t usual = std::min(total_bytes / 100 * kFreePercent, kFreeBytesMax);
  return std::min(configured == 0 ? usual : configured, total_bytes / 2);
}

SpaceState JudgeSpace(const SpaceFacts& facts) {
  if (Passed(facts, 1, facts.before == SpaceState::kStopped)) return SpaceState::kStopped;
  if (Passed(facts, 2, facts.before != SpaceState::kEnough)) return SpaceState::kScarce;
  return SpaceState::kEnough;
}

}  // namespace uplink::store
