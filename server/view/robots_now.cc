// Robots as watches show them: from memory, with what the store tells in a moment.
#include <algorithm>
#include <memory>
#include <numeric>
#include <utility>

#include "server/view/foreign_parts.h"
#include "server/view/queries.h"

namespace uplink::view {
namespace {

std::int64_t ActiveFaults(const FaultCounts::Map& faults, const std::string& ruri) {
  const auto found = faults.find(ruri);
  if (found == faults.end()) return 0;
  return std::accumulate(
      found->second.begin(), found->second.end(), std::int64_t{0},
      [](std::int64_t sum, auto count) { return sum + static_cast<std::int64_t>(count); });
}

}  // namespace

Queries::Seen Queries::SeenNow(bool with_glances) {
  const loop::Post post = sources_.to_store_thread ? loop::Post(sources_.to_store_thread)
                                                   : loop::Post([](const auto& job) {
                                                       job();
                                                       return true;
                                                     });
  if (sources_.faults != nullptr && !sources_.faults->fresh()) {
    sources_.faults->RefreshOn(post, sources_.fleet, sources_.reader);
  }
  if (with_glances && foreign_.due()) {
    foreign_reads_.PostBy(post, [this] { static_cast<void>(foreign_.Read()); });
  }
  return {.foreign = foreign_.glances(),
          .faults = sources_.faults != nullptr ? sources_.faults->counts() : nullptr};
}

std::vector<RobotView> Queries::Now(std::span<const fleet::RobotPtr> robots, const PartSet& parts,
                                    std::size_t bytes_max) {
  std::vector<RobotView> views;
  std::size_t bytes = 0;
  for (const fleet::RobotPtr& robot : robots) {
    bytes += CopyLarge(views.emplace_back(Look(*robot, parts)), parts);
    if (bytes >= bytes_max) break;
  }
  const std::vector<std::string> foreign = ForeignOf(views);
  if (!foreign.empty() || parts.AnyStored()) {
    // Of its own copy, which a late look may still be filling.
    auto filled = std::make_shared<std::vector<RobotView>>(views);
    const bool in_time = brief_look_.Run([this, filled, parts] {
      const absl::StatusOr<std::size_t> live = FillForeign(*filled);
      if (live.ok() && *live > 0) filled->resize(*live);
      const absl::StatusOr<std::size_t> stored = FillStored(*filled, parts);
      if (stored.ok() && *stored > 0) filled->resize(*stored);
    });
    if (in_time) views = std::move(*filled);
  }
  counts_.Fill(views);
  const auto faults = sources_.faults != nullptr ? sources_.faults->counts() : nullptr;
  if (faults == nullptr) return views;
  for (RobotView& view : views) view.active_faults = ActiveFaults(*faults, view.id.ruri);
  return views;
}

}  // namespace uplink::view
