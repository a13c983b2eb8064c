#include "server/journal/held_robots.h"

#include <utility>

namespace uplink::journal {

bool HeldRobots::Hold(robot::CommitClient& client, storage::Epoch since) {
  const auto [held, first] = since_.try_emplace(&client, since);
  return std::exchange(held->second, since) == since || first;
}

}  // namespace uplink::journal
