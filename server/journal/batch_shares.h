#pragma once

#include <cstddef>
#include <unordered_map>

#include "server/journal/entry.h"
#include "server/journal/limits.h"

namespace uplink::journal {

/// Shares a batch that is being filled among the robots whose entries wait. A robot's entries keep
/// their order: once one was left for a later batch, so are all behind it. A robot with nothing in
/// the batch may always have one entry, of any size.
///
/// Limits: one entry per robot of the batch.
/// Thread: confined to the writer.
class BatchShares final {
 public:
  explicit BatchShares(const BatchShare& share) : share_(share) {}

  /// Whether the robot's next entry goes into the batch.
  [[nodiscard]] bool Admit(const Origin& origin);

 private:
  struct Taken {
    std::size_t records = 0;
    std::size_t bytes = 0;
    bool full = false;
  };

  const BatchShare share_;
  std::unordered_map<const robot::CommitClient*, Taken> robots_;
};

}  // namespace uplink::journal
