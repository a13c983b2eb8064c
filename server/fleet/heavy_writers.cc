#include "server/fleet/heavy_writers.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace uplink::fleet {
namespace {

constexpr std::chrono::hours kHour{1};
constexpr std::uint64_t kHourSeconds = std::chrono::seconds(kHour).count();

/// The weight of bytes that were stored so long ago.
double LeftAfter(milliseconds passed) {
  return std::exp(-std::chrono::duration<double>(passed) / std::chrono::duration<double>(kHour));
}

}  // namespace

void HeavyWriters::Sample(std::span<const RobotPtr> robots, milliseconds passed) {
  time_ += passed;
  ++look_;
  const double left = LeftAfter(passed);
  for (const RobotPtr& robot : robots) {
    Entry& entry = entries_[robot.get()];
    if (entry.look == 0) entry.robot = robot;
    entry.look = look_;
    entry.hour_bytes *= left;
    const std::uint64_t total = robot->flow.bytes_total();
    const std::uint64_t stored = total - std::exchange(entry.bytes_total, total);
    if (stored == 0) continue;
    entry.hour_bytes += static_cast<double>(stored);
    entry.stored_at = time_;
  }
  std::erase_if(entries_, [this](const auto& each) {
    const bool gone = each.second.look != look_;
    if (gone && each.second.named) --named_;
    return gone;
  });
  FindMedian();
}

bool HeavyWriters::StoresAnything(const Entry& entry) const {
  return entry.hour_bytes > 0 && time_ - entry.stored_at < kHour;
}

std::uint64_t HeavyWriters::PerHour(double hour_bytes) const {
  const double looked = 1 - LeftAfter(time_);
  return looked > 0 ? static_cast<std::uint64_t>(hour_bytes / looked) : 0;
}

void HeavyWriters::FindMedian() {
  std::vector<double> stored;
  stored.reserve(entries_.size());
  for (const auto& [robot, entry] : entries_) {
    if (StoresAnything(entry)) stored.push_back(entry.hour_bytes);
  }
  median_hour_bytes_ = 0;
  if (stored.empty()) return;
  const auto middle = stored.begin() + static_cast<std::ptrdiff_t>((stored.size() - 1) / 2);
  std::ranges::nth_element(stored, middle);
  median_hour_bytes_ = *middle;
}

std::uint64_t HeavyWriters::rate() const {
  return std::max(median() / kHourSeconds, kHeavyRateMin);
}

std::vector<HeavyWriters::Writer> HeavyWriters::Heaviest(std::size_t count) const {
  std::vector<const Entry*> stored;
  stored.reserve(entries_.size());
  for (const auto& [robot, entry] : entries_) {
    if (StoresAnything(entry)) stored.push_back(&entry);
  }
  const auto end = stored.begin() + static_cast<std::ptrdiff_t>(std::min(count, stored.size()));
  std::ranges::partial_sort(stored, end, std::ranges::greater(),
                            [](const Entry* entry) { return entry->hour_bytes; });
  stored.erase(end, stored.end());
  std::vector<Writer> heaviest;
  heaviest.reserve(stored.size());
  for (const Entry* entry : stored) {
    const RobotPtr robot = entry->robot.lock();
    if (robot != nullptr) heaviest.push_back({robot->ruri(), PerHour(entry->hour_bytes)});
  }
  return heaviest;
}

std::vector<HeavyWriters::Writer> HeavyWriters::Name() {
  const double bound = median_hour_bytes_ * kHeavyTimes;
  std::vector<Writer> heavy;
  for (auto& [pointer, entry] : entries_) {
    const std::uint64_t stored = PerHour(entry.hour_bytes);
    const bool is_heavy = entry.hour_bytes > bound && stored > kHeavyRateMin * kHourSeconds;
    if (entry.named || !is_heavy || !StoresAnything(entry)) continue;
    const RobotPtr robot = entry.robot.lock();
    if (robot == nullptr) continue;
    entry.named = true;
    ++named_;
    heavy.push_back({robot->ruri(), stored});
  }
  std::ranges::sort(heavy, std::ranges::greater(), &Writer::bytes_per_hour);
  return heavy;
}

void HeavyWriters::Release() {
  for (auto& [robot, entry] : entries_) entry.named = false;
  named_ = 0;
}

bool HeavyWriters::IsNamed(const robot::Robot& robot) const {
  const auto entry = entries_.find(&robot);
  return entry != entries_.end() && entry->second.named;
}

}  // namespace uplink::fleet
