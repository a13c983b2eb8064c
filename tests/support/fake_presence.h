#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "storage/reader.h"
#include "storage/types.h"
#include "tests/support/fake_present.h"

namespace uplink::testing {

/// The presence changes that a FakeDatabase has, and the sessions of processes that number them.
/// Confined to its lock.
class FakePresence final {
 public:
  /// Writes what is above the cursor of the batch's session. `entries` counts all rows.
  /// `no_cursor` plants a fault: what the cursor covers is written again.
  void Write(const storage::Batch& batch, std::uint64_t& entries, bool no_cursor);

  /// As storage::Store::Retain, with the first day that is kept.
  std::size_t EraseHistory(SystemTime until) {
    return EraseBefore(changes_, until, storage::kRetainRowsMax);
  }

  /// The latest change, even if its row is gone.
  [[nodiscard]] std::optional<storage::PresenceRow> Last(std::string_view ruri) const;
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
  std::map<std::string, storage::PresenceRow, std::less<>> last_;
  std::map<model::SessionId, Session> sessions_;
};

}  // namespace uplink::testing
