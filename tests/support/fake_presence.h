#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "storage/batch.h"
#include "storage/bounds.h"
#include "storage/outcome.h"
#include "storage/presence.h"
#include "storage/reader.h"
#include "tests/support/fake_present.h"

namespace uplink::testing {

/// The presence changes that a FakeDatabase has, and the sessions of processes that number them.
/// Confined to its lock.
class FakePresence final {
 public:
  /// True for a change that another process's hold of the robot fences.
  using IsFenced = std::function<bool(const storage::PresenceItem& item)>;
  /// Writes what is not fenced and is above the cursor of the batch's session; an outcome per
  /// change. `entries` counts all rows. `no_cursor` plants a fault: what the cursor covers is
  /// written again.
  std::vector<storage::Outcome> Write(const storage::Batch& batch, std::uint64_t& entries,
                                      const IsFenced& is_fenced, bool no_cursor);

  /// As storage::Store::Retain, with the first day that is kept.
  std::size_t EraseHistory(SystemTime until) {
    return EraseBefore(changes_, until, storage::kRetainRowsMax);
  }

  /// The latest change, even if its row is gone.
  [[nodiscard]] std::optional<storage::StoredPresence> Last(std::string_view ruri) const;
  /// Nothing while the session is not known.
  [[nodiscard]] std::optional<model::Seq> Cursor(const model::SessionId& session) const;

  [[nodiscard]] const std::vector<FakeEntry<storage::PresenceRow>>& changes() const {
    return changes_;
  }

 private:
  struct Session {
    model::Seq cursor = 0;
    /// The entries that there were at its last use.
    std::uint64_t last_used = 0;
  };

  std::vector<FakeEntry<storage::PresenceRow>> changes_;
  /// What Retain leaves.
  std::map<std::string, storage::StoredPresence, std::less<>> last_;
  std::map<model::SessionId, Session> sessions_;
};

}  // namespace uplink::testing
