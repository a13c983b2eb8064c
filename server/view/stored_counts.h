#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "storage/reader.h"

namespace uplink::view {

struct RobotView;

/// Counts of each robot's active faults and open requests as last read from the store. They are
/// shown also while it is away.
///
/// Limits: twice robots_max robots.
/// Thread: thread-safe.
class StoredCounts final {
 public:
  struct Context {
    /// Outlives this.
    storage::Reader& reader;
    std::size_t robots_max = 0;
    /// Drones call here: only they have requests to operators.
    bool with_requests = false;
  };
  explicit StoredCounts(const Context& context) : context_(context) {}

  /// False if the store did not answer.
  bool Read(const std::vector<std::string>& ruris);
  /// Copies the counts into the robots; open requests only for those that do not call here.
  void Fill(std::vector<RobotView>& robots) const;

 private:
  struct Counts {
    std::int64_t active_faults = 0;
    std::int64_t open_requests = 0;
  };

  const Context context_;
  mutable std::mutex mutex_;
  std::unordered_map<std::string, Counts> counts_;
};

}  // namespace uplink::view
