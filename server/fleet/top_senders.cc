#include "server/fleet/top_senders.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "storage/fleets.h"
#include "storage/origin.h"

namespace uplink::fleet {
namespace {

using Seconds = std::chrono::duration<double>;

/// The weight of what was sent so long ago.
double LeftAfter(Seconds passed) { return std::exp(-passed / Seconds(kTopWindow)); }

std::array<std::uint64_t, kTopByNames.size()> TotalsOf(const robot::Robot& robot) {
  const robot::Traffic::Totals totals = robot.traffic.totals();
  // In the order of TopBy.
  return {totals.messages, totals.bytes, totals.rows};
}

}  // namespace

std::optional<TopBy> TopByFromText(std::string_view text) {
  const auto* const name = std::ranges::find(kTopByNames, text);
  if (name == kTopByNames.end()) return std::nullopt;
  return static_cast<TopBy>(name - kTopByNames.begin());
}

void TopSenders::Look() {
  const std::vector<RobotPtr> robots = fleet_.All();
  const SteadyTime now = clock_.Steady();
  const std::lock_guard lock(mutex_);
  const Seconds passed = looked_at_ ? Seconds(now - *looked_at_) : Seconds(0);
  if (looked_at_ && passed < kTopApart) return;
  looked_at_ = now;
  looked_for_ += passed;
  ++look_;
  const double left = LeftAfter(passed);
  for (const RobotPtr& robot : robots) {
    const auto totals = TotalsOf(*robot);
    const auto [at, is_new] = entries_.try_emplace(robot.get());
    Entry& entry = at->second;
    entry.look = look_;
    if (is_new) {
      entry.robot = robot;
      // What came before the first look of all has no time.
      if (look_ == 1) entry.totals = totals;
    }
    for (std::size_t by = 0; by < totals.size(); ++by) {
      const std::uint64_t more = totals[by] - std::exchange(entry.totals[by], totals[by]);
      entry.sent[by] = entry.sent[by] * left + static_cast<double>(more);
    }
  }
  std::erase_if(entries_, [this](const auto& each) { return each.second.look != look_; });
}

double TopSenders::PerSecond(double sent) const {
  const double looked = 1 - LeftAfter(looked_for_);
  return looked > 0 ? sent / (Seconds(kTopWindow).count() * looked) : 0;
}

std::vector<TopSenders::Rated> TopSenders::RatedBy(TopBy by) {
  const auto at = static_cast<std::size_t>(by);
  std::vector<Rated> senders;
  const std::lock_guard lock(mutex_);
  for (const auto& [pointer, entry] : entries_) {
    if (entry.sent[at] <= 0) continue;
    RobotPtr robot = entry.robot.lock();
    if (robot == nullptr) continue;
    senders.push_back({.per_second = PerSecond(entry.sent[at]), .robot = std::move(robot)});
  }
  return senders;
}

std::vector<TopSenders::Sender> TopSenders::Most(TopBy by, std::size_t count,
                                                 std::span<const std::string> fleets) {
  Look();
  std::vector<Rated> senders = RatedBy(by);
  std::erase_if(senders, [&](const Rated& sender) {
    return storage::IsNoRobot(sender.robot->ruri()) ||
           !storage::LooksAt(fleets, sender.robot->id()->fleet);
  });
  const std::size_t named = std::min({count, senders.size(), kTopMax});
  std::ranges::partial_sort(senders, senders.begin() + static_cast<std::ptrdiff_t>(named),
                            [](const Rated& a, const Rated& b) {
                              if (a.per_second != b.per_second) return a.per_second > b.per_second;
                              return a.robot->ruri() < b.robot->ruri();
                            });
  std::vector<Sender> most;
  for (std::size_t i = 0; i < named; ++i) {
    const Rated& sender = senders[i];
    most.push_back({sender.robot->ruri(), sender.robot->id()->fleet, sender.per_second});
  }
  return most;
}

}  // namespace uplink::fleet
