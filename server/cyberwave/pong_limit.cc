#include "server/cyberwave/pong_limit.h"

#include <chrono>
#include <utility>

namespace uplink::cyberwave {
namespace {

constexpr std::chrono::seconds kSpan{1};

}  // namespace

bool PongLimit::Take(std::string_view pong_topic, SteadyTime now) {
  if (all_.IsFull(now, kSpan)) return false;
  std::string name(pong_topic);
  if (by_name_.size() >= kPongNamesMax && !by_name_.contains(name)) {
    // At most kPongsMax of them stay.
    std::erase_if(by_name_,
                  [now](const auto& each) { return each.second.Within(now, kSpan) == 0; });
  }
  if (!by_name_[std::move(name)].Take(now, kSpan)) return false;
  all_.Note(now);
  return true;
}

}  // namespace uplink::cyberwave
