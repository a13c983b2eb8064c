#include "server/forward/shares.h"

#include <algorithm>
#include <utility>

namespace uplink::forward {

bool Shares::Resize(const Holder& holder, std::size_t before, std::size_t after) {
  const auto robot = robots_.try_emplace(holder.ruri, 0).first;
  const auto fleet = fleets_.try_emplace(holder.fleet, 0).first;
  const std::size_t of_robot = robot->second - before + after;
  const std::size_t of_fleet = fleet->second - before + after;
  const std::size_t all = bytes_.load() - before + after;
  const bool grows = after > before;
  const bool fits = !grows || (of_robot <= limits_.robot_bytes_max &&
                               of_fleet <= limits_.fleet_bytes_max && all <= limits_.bytes_max);
  if (fits) {
    robot->second = of_robot;
    fleet->second = of_fleet;
    bytes_ = all;
  }
  if (robot->second == 0) robots_.erase(robot);
  if (fleet->second == 0) fleets_.erase(fleet);
  if (after < before) NoteRoom(holder.ruri);
  return fits;
}

void Shares::NoteRoom(const std::string& ruri) {
  for (auto& [robot, left_out] : robots_left_out_) {
    left_out.to_look_at = left_out.to_look_at || left_out.for_others || robot == ruri;
  }
}

void Shares::NoteChanged(const std::string& ruri) {
  const auto robot = robots_left_out_.find(ruri);
  if (robot != robots_left_out_.end()) robot->second.to_look_at = true;
}

void Shares::NoteLeftOut(const Holder& holder) {
  const auto has = [](const auto& bytes, const std::string& of) {
    const auto found = bytes.find(of);
    return found == bytes.end() ? 0 : found->second;
  };
  ++left_out_;
  LeftOut& left_out = robots_left_out_[holder.ruri];
  ++left_out.times;
  // Whose room was the smaller one: that is what must grow.
  const std::size_t own = limits_.robot_bytes_max - has(robots_, holder.ruri);
  const std::size_t others = std::min(limits_.fleet_bytes_max - has(fleets_, holder.fleet),
                                      limits_.bytes_max - bytes_.load());
  left_out.for_others = left_out.for_others || others < own;
}

void Shares::Begin(LeftOut& left_out) { left_out = {.before = left_out.before + left_out.times}; }

void Shares::BeginLook(const std::string& ruri) {
  const auto robot = robots_left_out_.find(ruri);
  if (robot != robots_left_out_.end()) Begin(robot->second);
}

void Shares::BeginLookAtAll() {
  for (auto& [robot, left_out] : robots_left_out_) Begin(left_out);
}

void Shares::EndLook() {
  for (auto& [robot, left_out] : robots_left_out_) left_out_ -= std::exchange(left_out.before, 0);
  std::erase_if(robots_left_out_, [](const auto& entry) { return entry.second.times == 0; });
}

void Shares::BreakOffLook() {
  for (auto& [robot, left_out] : robots_left_out_) {
    left_out.to_look_at = left_out.to_look_at || left_out.before > 0;
  }
}

std::vector<std::string> Shares::ToLookAtAgain() const {
  std::vector<std::string> robots;
  for (const auto& [robot, left_out] : robots_left_out_) {
    if (left_out.to_look_at) robots.push_back(robot);
  }
  return robots;
}

std::set<std::string> Shares::robots_left_out() const {
  std::set<std::string> robots;
  for (const auto& [robot, left_out] : robots_left_out_) robots.insert(robots.end(), robot);
  return robots;
}

}  // namespace uplink::forward
