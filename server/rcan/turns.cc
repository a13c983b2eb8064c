#include "server/rcan/turns.h"

#include <queue>
#include <utility>

namespace uplink::rcan {
namespace {

/// How much a group has taken, and its number: the one that has taken least comes first.
using Place = std::pair<std::size_t, std::size_t>;
using Queue = std::priority_queue<Place, std::vector<Place>, std::greater<>>;

Place Pop(Queue& queue) {
  const Place first = queue.top();
  queue.pop();
  return first;
}

std::size_t Wanted(const ScrapeTurns::Turn& series) { return series.taken + series.left_out; }

}  // namespace

std::string_view ToText(Way way) {
  switch (way) {
    case Way::kGateway:
      return "gateway";
    case Way::kOwnStream:
      return "own_stream";
    case Way::kBroker:
      return "broker";
    case Way::kNotHeard:
      break;
  }
  return "not_heard";
}

void ScrapeTurns::Add(Sharer sharer, std::size_t robot) {
  groups_[std::move(sharer)].robots.push_back(robot);
}

void ScrapeTurns::Give(const std::function<Turn(std::size_t robot)>& turn) {
  struct Waiting {
    Group* group;
    std::size_t next;
  };
  std::vector<Waiting> waiting;
  std::vector<Queue> fleets;
  const std::string* fleet = nullptr;
  for (auto& [sharer, group] : groups_) {
    if (fleet == nullptr || sharer.fleet != *fleet) fleets.emplace_back();
    fleet = &sharer.fleet;
    fleets.back().emplace(0, waiting.size());
    waiting.push_back({.group = &group, .next = 0});
  }
  Queue queue;
  for (std::size_t i = 0; i < fleets.size(); ++i) queue.emplace(0, i);
  while (!queue.empty()) {
    const auto [taken_by_fleet, fleet_number] = Pop(queue);
    Queue& sharers = fleets[fleet_number];
    const auto [taken, number] = Pop(sharers);
    auto& [group, next] = waiting[number];
    const Turn series = turn(group->robots[next++]);
    group->series.taken += series.taken;
    group->series.left_out += series.left_out;
    if (next < group->robots.size()) sharers.emplace(taken + series.taken, number);
    if (!sharers.empty()) queue.emplace(taken_by_fleet + series.taken, fleet_number);
  }
}

std::optional<ScrapeTurns::Share> ScrapeTurns::Greediest() const {
  std::optional<Share> most;
  for (const auto& [sharer, group] : groups_) {
    if (group.series.left_out == 0) continue;
    if (!most || Wanted(group.series) > Wanted(most->series)) most = {sharer, group.series};
  }
  return most;
}

}  // namespace uplink::rcan
