#include "server/journal/held_robots.h"

#include <utility>

namespace uplink::journal {

HeldRobots::Hold HeldRobots::Begin(robot::CommitClient& client, storage::Epoch since) {
  const auto [held, first] = since_.try_emplace(&client, since);
  if (first) return Hold::kNew;
  return std::exchange(held->second, since) == since ? Hold::kSame : Hold::kInterrupted;
}

}  // namespace uplink::journal
