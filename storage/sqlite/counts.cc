#include "storage/sqlite/counts.h"

#include "schema/base/check.h"

namespace uplink::storage::sqlite {

absl::StatusOr<std::size_t> CountOf(Statement& count, std::string_view ruri) {
  Rows rows = count.Select(ruri);
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  UPLINK_CHECK(*found, "a count is a row");
  return static_cast<std::size_t>(rows.Int(0));
}

absl::StatusOr<std::size_t> CountReturned(Rows rows) {
  std::size_t count = 0;
  while (true) {
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok()) return found.status();
    if (!*found) return count;
    ++count;
  }
}

}  // namespace uplink::storage::sqlite
