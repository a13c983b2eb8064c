#include "server/rcan/scope_counts.h"

#include <algorithm>

namespace uplink::rcan {

void ScopeCounts::Note(const std::vector<std::string>& fleets, const Counts& counts, bool full,
                       SteadyTime now) {
  std::erase_if(entries_, [&](const auto& entry) { return now - entry.second.at >= age_max_; });
  if (entries_.size() >= kScopesCountedMax && !entries_.contains(fleets)) {
    entries_.erase(
        std::ranges::min_element(entries_, {}, [](const auto& entry) { return entry.second.at; }));
  }
  entries_[fleets] = {.counts = counts, .full = full, .at = now};
}

ScopeCounts::Counts ScopeCounts::Largest() const {
  Counts largest;
  for (const auto& [fleets, entry] : entries_) {
    const Counts& counts = entry.counts;
    largest.series = std::max(largest.series, counts.series);
    largest.robots_left_out = std::max(largest.robots_left_out, counts.robots_left_out);
    largest.robots_incomplete = std::max(largest.robots_incomplete, counts.robots_incomplete);
    largest.bytes = std::max(largest.bytes, counts.bytes);
  }
  return largest;
}

SteadyTime ScopeCounts::full_at() const {
  SteadyTime latest;
  for (const auto& [fleets, entry] : entries_) {
    if (entry.full) latest = std::max(latest, entry.at);
  }
  return latest;
}

}  // namespace uplink::rcan
