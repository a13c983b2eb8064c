#include "server/forward/shares.h"

#include <algorithm>
#include <utility>

namespace uplink::forward {

Shares::Taken Shares::TakenBy(const Holder& holder) const {
  Taken taken{.all = bytes_.load()};
  const auto fleet = fleets_.find(holder.fleet);
  if (fleet == fleets_.end()) return taken;
  taken.fleet = fleet->second.bytes;
  const auto robot = fleet->second.robots.find(holder.ruri);
  if (robot != fleet->second.robots.end()) taken.robot = robot->second;
  return taken;
}

void Shares::Set(const Holder& holder, const Taken& taken) {
  Fleet& fleet = fleets_[holder.fleet];
  const auto robot = fleet.robots.try_emplace(holder.ruri, 0).first;
  fleet.by_bytes.erase({robot->second, holder.ruri});
  if (taken.robot > 0) {
    robot->second = taken.robot;
    fleet.by_bytes.emplace(taken.robot, holder.ruri);
  } else {
    fleet.robots.erase(robot);
  }
  fleet.bytes = taken.fleet;
  bytes_ = taken.all;
  if (fleet.robots.empty()) fleets_.erase(holder.fleet);
}

bool Shares::Resize(const Holder& holder, std::size_t before, std::size_t after) {
  Taken taken = TakenBy(holder);
  for (std::size_t* bytes : {&taken.robot, &taken.fleet, &taken.all}) *bytes += after - before;
  if (after > before && !Fits(taken)) return false;
  Set(holder, taken);
  if (after < before) NoteRoom(holder.ruri);
  return true;
}

std::optional<Shares::OwnedHolder> Shares::ChooseToGiveWay(const Holder& holder, std::size_t before,
                                                           std::size_t after) const {
  Taken taken = TakenBy(holder);
  for (std::size_t* bytes : {&taken.robot, &taken.fleet, &taken.all}) *bytes += after - before;
  if (taken.robot > limits_.robot_bytes_max) return std::nullopt;
  auto fleet = fleets_.find(holder.fleet);
  if (taken.fleet <= limits_.fleet_bytes_max) {
    fleet =
        std::ranges::max_element(fleets_, {}, [](const auto& entry) { return entry.second.bytes; });
  }
  if (fleet == fleets_.end() || fleet->second.by_bytes.empty()) return std::nullopt;
  const auto& [bytes, ruri] = *fleet->second.by_bytes.rbegin();
  if (ruri == holder.ruri || bytes / 2 < taken.robot) return std::nullopt;
  return OwnedHolder{ruri, fleet->first};
}

bool Shares::MayFit(const Holder& holder, std::size_t bytes) const {
  Taken taken = TakenBy(holder);
  for (std::size_t* of : {&taken.robot, &taken.fleet, &taken.all}) *of += bytes;
  return Fits(taken) || ChooseToGiveWay(holder, 0, bytes);
}

std::string Shares::MostOf(const std::string& fleet) const {
  const auto known = fleets_.find(fleet);
  return known == fleets_.end() ? std::string() : known->second.by_bytes.rbegin()->second;
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
  ++left_out_;
  LeftOut& left_out = robots_left_out_[holder.ruri];
  left_out.fleet = holder.fleet;
  ++left_out.times;
  // The scarcer room is the one that must grow.
  const Taken taken = TakenBy(holder);
  const std::size_t own = limits_.robot_bytes_max - taken.robot;
  const std::size_t others =
      std::min(limits_.fleet_bytes_max - taken.fleet, limits_.bytes_max - taken.all);
  left_out.for_others = left_out.for_others || others < own;
}

void Shares::Begin(LeftOut& left_out) {
  left_out = {.fleet = left_out.fleet, .before = left_out.before + left_out.times};
}

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

std::vector<std::string> Shares::DueForLook() const {
  std::vector<std::string> robots;
  for (const auto& [robot, left_out] : robots_left_out_) {
    if (left_out.to_look_at) robots.push_back(robot);
  }
  return robots;
}

std::map<std::string, std::string> Shares::robots_left_out() const {
  std::map<std::string, std::string> robots;
  for (const auto& [robot, left_out] : robots_left_out_) {
    robots.emplace_hint(robots.end(), robot, MostOf(left_out.fleet));
  }
  return robots;
}

}  // namespace uplink::forward
