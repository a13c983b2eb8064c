#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "schema/base/clock.h"

namespace uplink::rcan {

/// Scopes whose last scrapes are remembered; the one that was scraped longest ago makes room.
inline constexpr std::size_t kScopesCountedMax = 32;

/// What the last scrape of each scope held and left out. So one that shows few robots does not hide
/// that another one lacks room.
///
/// Limits:  kScopesCountedMax entries.
/// Thread:  confined to its owner.
class ScopeCounts final {
 public:
  struct Counts {
    std::int64_t series = 0;
    std::int64_t robots_left_out = 0;
    std::int64_t robots_incomplete = 0;
    std::int64_t bytes = 0;
  };

  /// Counts that are as old as `age_max` go.
  explicit ScopeCounts(milliseconds age_max) : age_max_(age_max) {}

  /// `full`: it left out robots, or series of one, for lack of room.
  void Note(const std::vector<std::string>& fleets, const Counts& counts, bool full,
            SteadyTime now);

  /// The largest of each.
  [[nodiscard]] Counts Largest() const;
  /// When a scope that was full was scraped last; SteadyTime(): none was.
  [[nodiscard]] SteadyTime full_at() const;

 private:
  struct Entry {
    Counts counts;
    bool full = false;
    SteadyTime at;
  };

  const milliseconds age_max_;
  std::map<std::vector<std::string>, Entry> entries_;
};

}  // namespace uplink::rcan
