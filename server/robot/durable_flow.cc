#include "server/robot/durable_flow.h"

#include <algorithm>
#include <chrono>

namespace uplink::robot {
namespace {

/// How soon a robot that is held back looks again: a reload, or room on the disk, may release it
/// before its bucket does.
constexpr std::chrono::seconds kAgain{1};
/// What a robot that the disk limits may store at once, in seconds of its rate.
constexpr std::uint64_t kDiskBurstSeconds = 10;

}  // namespace

limits::BucketSize DurableFlow::DiskSize(std::int64_t rate) const {
  const auto bytes = static_cast<std::uint64_t>(rate);
  return {.rate = bytes, .burst = bytes * kDiskBurstSeconds};
}

DurableFlow::Answer DurableFlow::LookAtDisk(SteadyTime now) const {
  if (disk_rate_.load(std::memory_order_relaxed) != 0) return {};
  return {HeldBack::kDisk, now + kAgain};
}

DurableFlow::Answer DurableFlow::LookAt(std::size_t bytes, const FlowLimits& limits,
                                        SteadyTime now) const {
  if (const Answer disk = LookAtDisk(now); disk.by != HeldBack::kNone) return disk;
  const std::int64_t disk_rate = disk_rate_.load(std::memory_order_relaxed);
  const std::lock_guard lock(mutex_);
  const SteadyTime flow = std::max(records_.PassesAt(1, limits.records, now),
                                   bytes_.PassesAt(bytes, limits.bytes, now));
  if (flow > now) return {HeldBack::kFlow, std::min<SteadyTime>(flow, now + kAgain)};
  if (disk_rate == kNoLimit) return {};
  const SteadyTime disk = disk_.PassesAt(bytes, DiskSize(disk_rate), now);
  if (disk <= now) return {};
  return {HeldBack::kDisk, std::min<SteadyTime>(disk, now + kAgain)};
}

void DurableFlow::Take(std::size_t bytes, const FlowLimits& limits, SteadyTime now) {
  const std::lock_guard lock(mutex_);
  records_.Take(1, limits.records, now);
  bytes_.Take(bytes, limits.bytes, now);
  bytes_total_.fetch_add(bytes, std::memory_order_relaxed);
  const std::int64_t disk_rate = disk_rate_.load(std::memory_order_relaxed);
  if (disk_rate > 0) disk_.Take(bytes, DiskSize(disk_rate), now);
}

void DurableFlow::LimitForDisk(std::optional<std::uint64_t> bytes_per_second) {
  disk_rate_.store(bytes_per_second ? static_cast<std::int64_t>(*bytes_per_second) : kNoLimit);
}

}  // namespace uplink::robot
