#include "server/cyberwave/pong_limit.h"

namespace uplink::cyberwave {

bool PongLimit::Take(std::string_view pong_topic, SteadyTime now) {
  if (all_.IsFull(now)) return false;
  std::string name(pong_topic);
  auto found = by_name_.find(name);
  if (found == by_name_.end()) {
    if (by_name_.size() >= kPongNamesMax) {
      // At most kPongsMax of them stay.
      std::erase_if(by_name_, [now](const auto& each) {
        return now - each.second.last() >= std::chrono::seconds(1);
      });
    }
    found = by_name_.try_emplace(std::move(name)).first;
  }
  if (found->second.IsFull(now)) return false;
  found->second.Add(now);
  all_.Add(now);
  return true;
}

}  // namespace uplink::cyberwave
