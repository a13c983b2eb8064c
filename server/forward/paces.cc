#include "server/forward/paces.h"

#include <algorithm>
#include <array>

#include "server/forward/limits.h"

namespace uplink::forward {
namespace {

/// How many changes of a robot may be due at once: the first of these that its rate lets out.
constexpr std::array<std::size_t, 5> kDueAtOnce = {kLookedUpMax, 64, 16, 4, 1};
constexpr std::chrono::seconds kDropIdleEvery{1};

}  // namespace

bool Paces::PassesNow(const Robot& robot, std::size_t changes, SteadyTime now) const {
  return robot.bucket.PassesAt(changes * robot.last_bytes, limits_.fan_out, now) <= now;
}

bool Paces::Passes(const ItemKey& key, Turn turn, SteadyTime now) {
  const auto known = robots_.find(key.ruri);
  if (known == robots_.end()) return true;
  Robot& robot = known->second;
  const bool first = turn == Turn::kWaited || robot.waiting.empty();
  if (first && robot.bucket.PassesAt(1, limits_.fan_out, now) <= now) {
    waiting_ -= robot.waiting.erase(key);
    return true;
  }
  if (robot.waiting.contains(key)) return false;
  if (waiting_ >= limits_.waiting_max) return true;
  robot.waiting.insert(key);
  ++waiting_;
  return false;
}

void Paces::NoteForwarded(const std::string& ruri, std::size_t bytes, SteadyTime now) {
  if (bytes == 0 || limits_.fan_out.rate == 0) return;
  Robot& robot = robots_[ruri];
  robot.last_bytes = bytes;
  robot.bucket.Take(bytes, limits_.fan_out, now);
}

void Paces::Forget(const ItemKey& key) {
  const auto robot = robots_.find(key.ruri);
  if (robot != robots_.end()) waiting_ -= robot->second.waiting.erase(key);
}

void Paces::ForgetAll() {
  for (auto& [ruri, robot] : robots_) robot.waiting.clear();
  waiting_ = 0;
}

void Paces::DropIdle(SteadyTime now) {
  if (!idle_looks_.Take(now, kDropIdleEvery)) return;
  std::erase_if(robots_, [&](const auto& entry) {
    const Robot& robot = entry.second;
    return robot.waiting.empty() && robot.bucket.IsFull(now);
  });
}

void Paces::AddDue(Robot& robot, SteadyTime now, std::vector<ItemKey>& into) const {
  const auto* const most = std::ranges::find_if(
      kDueAtOnce, [&](std::size_t changes) { return PassesNow(robot, changes, now); });
  if (most == kDueAtOnce.end()) return;
  auto next = robot.last ? robot.waiting.upper_bound(*robot.last) : robot.waiting.begin();
  const std::size_t count = std::min({*most, robot.waiting.size(), kDueMax - into.size()});
  for (std::size_t i = 0; i < count; ++i, ++next) {
    if (next == robot.waiting.end()) next = robot.waiting.begin();
    into.push_back(*next);
  }
  robot.last = into.back();
}

std::vector<ItemKey> Paces::Due(SteadyTime now) {
  DropIdle(now);
  std::vector<ItemKey> due;
  if (waiting_ == 0) return due;
  auto next = robots_.upper_bound(last_robot_);
  for (std::size_t i = 0; i < robots_.size() && due.size() < kDueMax; ++i, ++next) {
    if (next == robots_.end()) next = robots_.begin();
    if (!next->second.waiting.empty()) AddDue(next->second, now, due);
    last_robot_ = next->first;
  }
  return due;
}

std::optional<SteadyTime> Paces::DueAt(SteadyTime now) const {
  std::optional<SteadyTime> due;
  if (waiting_ == 0) return due;
  for (const auto& [ruri, robot] : robots_) {
    if (robot.waiting.empty()) continue;
    const SteadyTime at = robot.bucket.PassesAt(robot.last_bytes, limits_.fan_out, now);
    due = due ? std::min(*due, at) : at;
  }
  return due;
}

std::map<std::string, std::string> Paces::robots() const {
  std::map<std::string, std::string> robots;
  if (waiting_ == 0) return robots;
  for (const auto& [ruri, robot] : robots_) {
    if (!robot.waiting.empty()) robots.emplace(ruri, "");
  }
  return robots;
}

}  // namespace uplink::forward
