#include "tools/uplink-fleet/drone/outbox.h"

#include <algorithm>
#include <utility>

namespace uplink::synthetic {

void DroneOutbox::Add(AvatarCall call, SteadyTime now) {
  Line& line = lines_.at(call.line);
  const std::size_t stays = line.away ? 1 : 0;
  if (call.live && line.calls.size() > stays) {
    Waiting& last = line.calls.back();
    const bool same = last.call.number == call.number;
    // The same sample goes on waiting; a newer one is as due as it would have been.
    if (!same) last = {.call = std::move(call), .due = last.due, .tries = 0};
    return;
  }
  line.calls.push_back({.call = std::move(call), .due = now});
}

std::optional<DroneOutbox::Leaving> DroneOutbox::Next(SteadyTime now) {
  for (Line& line : lines_) {
    if (line.away || line.calls.empty() || now < line.again_at) continue;
    line.away = true;
    Waiting& first = line.calls.front();
    return Leaving{.call = first.call, .due = first.due, .tries = ++first.tries};
  }
  return std::nullopt;
}

void DroneOutbox::Answered(std::size_t at) {
  Line& line = lines_.at(at);
  line.away = false;
  line.backoff.Succeeded();
  line.calls.pop_front();
}

void DroneOutbox::Lost(std::size_t at, SteadyTime now) {
  Line& line = lines_.at(at);
  line.away = false;
  line.again_at = now + line.backoff.Next();
  line.backoff.Failed();
  if (line.calls.front().call.live && line.calls.size() > 1) line.calls.pop_front();
}

bool DroneOutbox::empty() const {
  return std::ranges::all_of(lines_, [](const Line& line) { return line.calls.empty(); });
}

}  // namespace uplink::synthetic
