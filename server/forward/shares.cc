#include "server/forward/shares.h"

#include <algorithm>
#include <utility>

namespace uplink::forward {

bool Shares::Resize(const std::string& ruri, std::size_t before, std::size_t after) {
  const auto place = robots_.try_emplace(ruri, 0).first;
  const std::size_t robot = place->second - before + after;
  const std::size_t all = bytes_.load() - before + after;
  const bool grows = after > before;
  const bool fits = !grows || (robot <= limits_.robot_bytes_max && all <= limits_.bytes_max);
  if (fits) {
    place->second = robot;
    bytes_ = all;
  }
  if (place->second == 0) robots_.erase(place);
  if (after < before) NoteRoom(ruri);
  return fits;
}

void Shares::NoteRoom(const std::string& ruri) {
  for (auto& [robot, left_out] : robots_left_out_) {
    left_out.has_room = left_out.has_room || left_out.for_all || robot == ruri;
  }
}

void Shares::NoteLeftOut(const std::string& ruri) {
  ++left_out_;
  LeftOut& left_out = robots_left_out_[ruri];
  ++left_out.times;
  const auto has = robots_.find(ruri);
  // Whose room was the smaller one: that is what must grow.
  const std::size_t own = has == robots_.end() ? 0 : has->second;
  left_out.for_all =
      left_out.for_all || limits_.bytes_max - bytes_.load() < limits_.robot_bytes_max - own;
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

std::optional<std::string> Shares::ToLookAtAgain() const {
  const auto robot = std::ranges::find_if(robots_left_out_,
                                          [](const auto& entry) { return entry.second.has_room; });
  if (robot == robots_left_out_.end()) return std::nullopt;
  return robot->first;
}

std::vector<std::string> Shares::robots_left_out() const {
  std::vector<std::string> robots;
  robots.reserve(robots_left_out_.size());
  for (const auto& [robot, left_out] : robots_left_out_) robots.push_back(robot);
  return robots;
}

}  // namespace uplink::forward
