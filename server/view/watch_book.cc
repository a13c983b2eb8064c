#include "server/view/watch_book.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <string_view>

#include <absl/hash/hash.h>
#include <fmt/core.h>

#include "server/view/parts.h"
#include "storage/fleets.h"

namespace uplink::view {
namespace {

/// A robot without its large parts.
constexpr std::size_t kShownBytes = std::size_t{4} * 1024;

/// `over` is the server's reason, if it ended the watch.
std::string_view TextOf(const absl::Status& over, WatchEnd why) {
  if (absl::IsDeadlineExceeded(over)) return "slow";
  if (!over.ok()) return "stop";
  switch (why) {
    case WatchEnd::kLeft:
      return "left";
    case WatchEnd::kDenied:
      return "denied";
    case WatchEnd::kDrained:
      return "drained";
  }
  return "";
}

absl::Status ServerStops() { return absl::UnavailableError("the server stops"); }

}  // namespace

std::size_t WatchBook::HashOfKey::operator()(const SharedKey& key) const {
  return absl::HashOf(key);
}

absl::Status WatchBook::RoomFor(const WatchQuery& query) const {
  if (stopped_) return ServerStops();
  if (watches_.size() >= kWatchesMax) {
    return absl::ResourceExhaustedError(fmt::format("{} watches are open already", kWatchesMax));
  }
  if (query.caller.empty()) return absl::OkStatus();
  const auto own = std::ranges::count_if(
      watches_, [&query](const auto& watch) { return watch->query.caller == query.caller; });
  if (static_cast<std::size_t>(own) < kWatchesPerCallerMax) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      fmt::format("{} watches of this caller are open already", kWatchesPerCallerMax));
}

absl::StatusOr<std::shared_ptr<WatchBook::Entry>> WatchBook::Begin(WatchQuery query,
                                                                   std::function<void()> ready) {
  const auto watch =
      std::make_shared<Entry>(std::move(query), std::move(ready), context_.clock.Steady());
  const bool looks = watch->filter.looks();
  const Queries::Seen seen = context_.queries.SeenNow(looks);
  const FilterSources sources = context_.queries.FilterSourcesOf(seen);
  const std::lock_guard lock(mutex_);
  if (absl::Status room = RoomFor(watch->query); !room.ok()) {
    context_.probe.refused.Add();
    return room;
  }
  // Marks of before the first watch are of no use.
  if (watches_.empty()) {
    robots_.LookAgain(
        sources, false, [](std::size_t, const std::string&) {}, [](const auto&) {});
  }
  watch->filter.SetSources(sources);
  robots_.ForEach(sources, looks, [&](const auto& robot) { Mark(*watch, robot); });
  watch->taken_at = context_.clock.Steady();
  watches_.push_back(watch);
  context_.probe.open.Add(1);
  return watch;
}

void WatchBook::Mark(Entry& watch, const WatchedRobots::Seen& robot) {
  if (watch.filter.Judge(robot.facts) == FilteredRobots::Match::kYes) {
    watch.marks.Show(robot.number);
  } else {
    watch.marks.Hide(robot.number, robot.facts.ruri);
  }
}

bool WatchBook::AnyLooks() const {
  return std::ranges::any_of(watches_, [](const auto& watch) { return watch->filter.looks(); });
}

void WatchBook::Sweep() {
  bool looks = false;
  {
    const std::lock_guard lock(mutex_);
    if (watches_.empty()) {
      shared_.clear();
      shared_bytes_ = 0;
      return robots_.Clear();
    }
    looks = AnyLooks();
  }
  const Queries::Seen seen = context_.queries.SeenNow(looks);
  const FilterSources sources = context_.queries.FilterSourcesOf(seen);
  std::vector<std::shared_ptr<Entry>> woken;
  {
    const std::lock_guard lock(mutex_);
    // Robots that were shown before may be older than what is found now.
    shared_.clear();
    shared_bytes_ = 0;
    ++sweeps_;
    looks = AnyLooks();
    for (const auto& watch : watches_) watch->filter.SetSources(sources);
    robots_.LookAgain(
        sources, looks,
        [this](std::size_t number, const std::string& ruri) {
          for (const auto& watch : watches_) watch->marks.Hide(number, ruri);
        },
        [this](const WatchedRobots::Seen& robot) {
          for (const auto& watch : watches_) Mark(*watch, robot);
        });
    const SteadyTime now = context_.clock.Steady();
    std::ranges::copy_if(watches_, std::back_inserter(woken),
                         [&](const auto& watch) { return MustWake(*watch, now); });
    const std::size_t over =
        std::erase_if(watches_, [](const auto& watch) { return !watch->over.ok(); });
    context_.probe.open.Add(-static_cast<std::int64_t>(over));
  }
  for (const auto& watch : woken) watch->ready();
}

bool WatchBook::MustWake(Entry& watch, SteadyTime now) {
  if (!watch.marks.any()) return false;
  if (std::exchange(watch.waiting, false)) {
    watch.taken_at = now;
    return true;
  }
  if (now - watch.taken_at <= kWatchTakeWait) return false;
  watch.over = absl::DeadlineExceededError(
      fmt::format("its reader took nothing for {} s", kWatchTakeWait.count()));
  context_.probe.slow.Add();
  return true;
}

absl::StatusOr<std::vector<WatchChange>> WatchBook::Take(Entry& watch) {
  while (true) {
    TakeResult result;
    {
      const std::lock_guard lock(mutex_);
      if (!watch.over.ok()) return watch.over;
      Collect(watch, result);
    }
    // A list that other processes' robots are read for ascends.
    std::ranges::sort(result.missing, {}, [](const auto& each) { return each.second->ruri(); });
    std::vector<fleet::RobotPtr> robots;
    for (const auto& [number, robot] : result.missing) robots.push_back(robot);
    std::vector<RobotShown> made;
    if (!robots.empty()) {
      for (RobotView& view : context_.queries.Now(robots, watch.query.parts, kWatchTakeBytesMax)) {
        made.push_back(std::make_shared<const WatchedRobot>(std::move(view), watch.query.parts));
      }
    }
    const std::lock_guard lock(mutex_);
    Finish(watch, made, result);
    watch.taken += result.changes.size();
    if (!result.changes.empty()) return std::move(result.changes);
    watch.waiting = !watch.marks.any();
    if (watch.waiting) return std::move(result.changes);
  }
}

void WatchBook::Collect(Entry& watch, TakeResult& result) {
  watch.taken_at = context_.clock.Steady();
  result.sweep = sweeps_;
  while (result.changes.size() < kWatchTakeMax) {
    std::optional<std::string> ruri = watch.marks.TakeRemoved();
    if (!ruri) break;
    result.changes.emplace_back(RobotRemoved{*std::move(ruri)});
    context_.probe.removed.Add();
  }
  while (result.changes.size() + result.missing.size() < kWatchTakeMax) {
    const std::optional<std::size_t> number = watch.marks.TakeRobot();
    if (!number) break;
    const auto shared = shared_.find({*number, watch.query.parts.number()});
    if (shared != shared_.end()) {
      if (!storage::LooksAt(watch.query.filter.fleets, shared->second->view().id.fleet)) continue;
      result.changes.emplace_back(shared->second);
      context_.probe.shown.Add();
    } else if (fleet::RobotPtr robot = robots_.Find(*number)) {
      result.missing.emplace_back(*number, std::move(robot));
    }
  }
}

void WatchBook::Finish(Entry& watch, const std::vector<RobotShown>& made, TakeResult& result) {
  for (std::size_t i = 0; i < made.size(); ++i) {
    if (result.sweep == sweeps_) {
      Share({result.missing[i].first, watch.query.parts.number()}, made[i]);
    }
    // It may have moved since it was noted; the next sweep sees that.
    if (!storage::LooksAt(watch.query.filter.fleets, made[i]->view().id.fleet)) continue;
    result.changes.emplace_back(made[i]);
    context_.probe.shown.Add();
  }
  std::vector<std::size_t> left;
  for (std::size_t i = made.size(); i < result.missing.size(); ++i) {
    left.push_back(result.missing[i].first);
  }
  std::ranges::sort(left, std::greater());
  for (const std::size_t number : left) watch.marks.PutBack(number);
  if (const auto robots = watch.marks.TakeSnapshotEnd()) {
    result.changes.emplace_back(SnapshotShown{*robots});
  }
}

void WatchBook::Share(const SharedKey& key, const RobotShown& robot) {
  const std::size_t bytes = kShownBytes + KeyedBytes(robot->view().state.parts);
  if (shared_bytes_ + bytes > kSharedBytesMax) return;
  if (shared_.emplace(key, robot).second) shared_bytes_ += bytes;
}

void WatchBook::End(const std::shared_ptr<Entry>& watch, WatchEnd why) {
  std::string_view text;
  std::uint64_t taken = 0;
  {
    const std::lock_guard lock(mutex_);
    const std::size_t open = watches_.remove(watch);
    if (open > 0) context_.probe.open.Add(-1);
    text = TextOf(watch->over, why);
    taken = watch->taken;
  }
  const auto age = context_.clock.Steady() - watch->began;
  ends_.Write(log::Level::kInfo, "watch_ended",
              {{"who", watch->query.caller},
               {"why", text},
               {"seconds", std::chrono::duration_cast<std::chrono::seconds>(age).count()},
               {"changes", taken}});
}

void WatchBook::Stop() {
  std::list<std::shared_ptr<Entry>> ended;
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    ended.swap(watches_);
    for (const auto& watch : ended) watch->over = ServerStops();
    context_.probe.open.Add(-static_cast<std::int64_t>(ended.size()));
    shared_.clear();
    robots_.Clear();
  }
  for (const auto& watch : ended) watch->ready();
}

std::size_t WatchBook::size() const {
  const std::lock_guard lock(mutex_);
  return watches_.size();
}

}  // namespace uplink::view
