#include "storage/postgres/write/sweep.h"

#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/bounds.h"
#include "storage/postgres/tables/present_sql.h"
#include "storage/postgres/write/transaction.h"
#include "storage/shared_items.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kSweepChanges =
    "SELECT uplinkd.sweep_changes($1::bigint, $2::int, $3::bigint)";

}  // namespace

absl::StatusOr<Swept> SweepRows(Connection& connection, SystemTime now, const StoreRules& rules,
                                const std::function<absl::Status()>& before_commit) {
  std::vector<StoreCall> calls;
  calls.push_back({kBegin, {}});
  const std::size_t first = calls.size();
  if (Vouches(rules.clock, now)) {
    for (const PresentKind kind : kItemKinds) {
      StoreCall& call = calls.emplace_back(StoreCall{PresentSqlOf(kind).sweep.view(), {}});
      call.parameters.Int8(UnixMs(now - kExpiredKept));
      call.parameters.Int8(static_cast<std::int64_t>(kSweepRowsMax));
    }
  }
  const std::size_t last = calls.size();
  // The last, so that the locks of items were taken by then. It goes by no clock of ours.
  StoreCall& changes = calls.emplace_back(StoreCall{kSweepChanges, {}});
  changes.parameters.Int8(static_cast<std::int64_t>(kChangesKept));
  changes.parameters.Int4(static_cast<std::int32_t>(kChangeWriterKept.count()));
  changes.parameters.Int8(static_cast<std::int64_t>(kChangesSweptMax));
  const auto results = RunAndCommitFor(connection, std::move(calls), "sweep", before_commit);
  if (!results.ok()) return results.status();
  Swept swept;
  for (std::size_t i = first; i < last; ++i) swept.items += (*results)[i].written();
  swept.changes = static_cast<std::size_t>((*results)[last].Int(0, 0));
  return swept;
}

}  // namespace uplink::storage::postgres
