#include "server/fleet/live_budget.h"

#include <algorithm>
#include <utility>

namespace uplink::fleet {
namespace {

/// The index of the part that holds all live data of a robot's calls.
constexpr std::size_t kOfCalls = storage::kLivePartKinds;

}  // namespace

LiveBudget::LiveBudget(const Context& context) : context_(context) {
  context_.fleet.live_total()->OnOver([this] { Relieve(); });
  context_.fleet.live_total()->SetTrigger(context_.bytes_max);
}

bool LiveBudget::over() const {
  if (bytes() > context_.bytes_max) return true;
  const SteadyTime dropped_at = dropped_at_.load();
  return dropped_at != SteadyTime() && context_.clock.Steady() - dropped_at < kLiveDroppedShown;
}

void LiveBudget::Round() {
  context_.fleet.live_total()->SetTrigger(context_.bytes_max);
  Relieve();
  Tell();
}

void LiveBudget::Relieve() {
  if (bytes() <= context_.bytes_max || relieving_.exchange(true)) return;
  std::vector<Holder> holders = Holders();
  std::ranges::make_heap(holders, {}, &Holder::bytes);
  while (bytes() > goal() && !holders.empty()) {
    std::ranges::pop_heap(holders, {}, &Holder::bytes);
    Holder most = std::move(holders.back());
    holders.pop_back();
    if (!DropLargest(most, holders.empty() ? 0 : holders.front().bytes)) continue;
    holders.push_back(std::move(most));
    std::ranges::push_heap(holders, {}, &Holder::bytes);
  }
  // Memory outside parts cannot be dropped. If that alone is over the budget, the next look comes
  // once a further 1 / kLiveRoomShare was added, not at each message.
  context_.fleet.live_total()->SetTrigger(
      std::max(context_.bytes_max, bytes() + context_.bytes_max / kLiveRoomShare));
  relieving_.store(false);
}

LiveBudget::Name LiveBudget::NameOf(const robot::Robot& robot) {
  std::optional<std::string> gateway = robot.speaker();
  if (!gateway) return {"robots", "not_heard"};
  if (gateway->empty()) return {"robot", robot.ruri()};
  return {"gateway", *std::move(gateway)};
}

std::vector<LiveBudget::Holder> LiveBudget::Holders() const {
  std::map<Name, Holder> by_name;
  const auto holder_of = [&by_name](Name name, std::size_t bytes) -> Holder& {
    Holder& holder = by_name[name];
    holder.name = std::move(name);
    holder.bytes += bytes;
    return holder;
  };
  for (const RobotPtr& robot : context_.fleet.All()) {
    const std::size_t held = robot->state.live_bytes() + robot->calls.live_bytes();
    if (held == 0) continue;
    holder_of(NameOf(*robot), held).robots.push_back(robot);
  }
  for (const cyberwave::TwinPtr& twin : context_.twins.All()) {
    holder_of({"twin", twin->id().ToText()}, twin->bytes()).twins.push_back(twin);
  }
  std::vector<Holder> holders;
  holders.reserve(by_name.size());
  for (auto& [name, holder] : by_name) holders.push_back(std::move(holder));
  return holders;
}

std::vector<LiveBudget::Part> LiveBudget::PartsOf(const Holder& holder) {
  std::vector<Part> parts;
  const auto add = [&parts](const auto& bytes, const RobotPtr& robot,
                            const cyberwave::TwinPtr& twin) {
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      if (bytes[i] == 0) continue;
      parts.push_back({.bytes = bytes[i], .robot = robot, .twin = twin, .index = i});
    }
  };
  for (const RobotPtr& robot : holder.robots) {
    add(robot->state.live_part_bytes(), robot, nullptr);
    const std::size_t said = robot->calls.live_bytes();
    if (said != 0) parts.push_back({.bytes = said, .robot = robot, .index = kOfCalls});
  }
  for (const cyberwave::TwinPtr& twin : holder.twins) add(twin->table_bytes(), nullptr, twin);
  std::ranges::sort(parts, {}, &Part::bytes);
  return parts;
}

bool LiveBudget::DropLargest(Holder& most, std::size_t next_bytes) {
  if (!most.parts) most.parts = PartsOf(most);
  if (most.parts->empty()) return false;
  Loss loss{.held_bytes = most.bytes};
  do {
    const std::size_t freed = Drop(most.parts->back());
    most.parts->pop_back();
    ++loss.parts;
    loss.bytes += freed;
    most.bytes -= std::min(most.bytes, freed);
  } while (!most.parts->empty() && most.bytes > next_bytes && bytes() > goal());
  parts_dropped_.fetch_add(loss.parts);
  dropped_at_.store(context_.clock.Steady());
  const std::lock_guard lock(mutex_);
  Loss& told = losses_[most.name];
  told.held_bytes = std::max(told.held_bytes, loss.held_bytes);
  told.parts += loss.parts;
  told.bytes += loss.bytes;
  return true;
}

std::size_t LiveBudget::Drop(const Part& part) {
  if (part.twin != nullptr) {
    return context_.twins.DropTable(*part.twin, static_cast<cyberwave::TwinTable>(part.index));
  }
  if (part.index == kOfCalls) return part.robot->calls.DropLive();
  return part.robot->state.DropLivePart(static_cast<storage::LivePart>(part.index));
}

void LiveBudget::Tell() {
  const SteadyTime now = context_.clock.Steady();
  std::map<Name, Loss> losses;
  {
    const std::lock_guard lock(mutex_);
    if (losses_.empty() || !told_.Take(now, kLiveLineEvery)) return;
    losses.swap(losses_);
  }
  Loss all;
  for (const auto& [name, loss] : losses) {
    all.parts += loss.parts;
    all.bytes += loss.bytes;
  }
  const auto& [name, most] =
      *std::ranges::max_element(losses, {}, [](const auto& each) { return each.second.bytes; });
  context_.logger.Warn("live_state_dropped", {{name.key, name.text},
                                              {"held_bytes", most.held_bytes},
                                              {"parts", most.parts},
                                              {"bytes", most.bytes},
                                              {"other_holders", losses.size() - 1},
                                              {"parts_total", all.parts},
                                              {"bytes_total", all.bytes},
                                              {"live_bytes_max", context_.bytes_max}});
}

}  // namespace uplink::fleet
