#pragma once

#include <cstddef>
#include <vector>

#include <absl/status/statusor.h>

#include "server/view/message_printer.h"
#include "server/view/story.h"
#include "storage/reader.h"

namespace uplink::view {

/// Rejected messages of one reason that a story tells as one entry. A value.
struct RejectGroup {
  /// Of the row that came first in the walk.
  StoryPlace place;
  storage::QuarantineRow first;
  std::size_t count = 0;
  SystemTime earliest;
  SystemTime latest;
};

/// Rows as entries of a story: a sentence for a person, and the row as JSON. Errors: as
/// MessagePrinter. Confined to one thread.
class StoryEntries final {
 public:
  [[nodiscard]] absl::StatusOr<StoryEntry> Of(const StoryPlace& place,
                                              const storage::PresenceRow& row) const;
  [[nodiscard]] absl::StatusOr<StoryEntry> Of(const StoryPlace& place,
                                              const storage::FaultRow& row) const;
  [[nodiscard]] absl::StatusOr<StoryEntry> Of(const StoryPlace& place,
                                              const storage::MissionRunRow& row) const;
  [[nodiscard]] absl::StatusOr<StoryEntry> Of(const RejectGroup& group) const;
  /// What a robot's connections tell: at most four entries each. `page` holds all of them, newest
  /// first.
  [[nodiscard]] absl::StatusOr<std::vector<StoryEntry>> Of(
      const storage::Page<storage::ConnectionRow>& page) const;

 private:
  const MessagePrinter printer_;
};

}  // namespace uplink::view
