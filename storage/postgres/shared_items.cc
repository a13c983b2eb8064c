#include "storage/shared_items.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/change_walk.h"
#include "storage/gathered_page.h"
#include "storage/postgres/own_connection.h"
#include "storage/postgres/pages.h"
#include "storage/postgres/parts.h"
#include "storage/read_row.h"

namespace uplink::storage::postgres {
namespace {

/// Keys that one statement looks up: not all of what very large items hold is read at once.
constexpr std::size_t kKeysPerStatement = kFirstChunkRows;

// Read before the rest, so that nothing later counts as read.
constexpr std::string_view kNow = "SELECT clock_timestamp()";
constexpr std::string_view kLast =
    "SELECT w.writer, l.number, l.noted_at FROM uplinkd.change_writers AS w"
    " CROSS JOIN LATERAL (SELECT c.number, c.noted_at FROM uplinkd.changes AS c"
    " WHERE c.writer = w.writer ORDER BY c.number DESC LIMIT 1) AS l";
constexpr std::string_view kSince =
    "SELECT w.writer, c.number, c.noted_at, c.kind, c.origin, c.id"
    " FROM uplinkd.change_writers AS w"
    " LEFT JOIN unnest($1::uuid[], $2::bigint[]) AS p (writer, number) ON p.writer = w.writer"
    " CROSS JOIN LATERAL (SELECT s.* FROM uplinkd.changes AS s"
    " WHERE s.writer = w.writer AND s.number > coalesce(p.number, 0)"
    " ORDER BY s.number LIMIT $3::bigint) AS c"
    " ORDER BY w.writer, c.number LIMIT $3::bigint";

/// $1, $2: after which robot and id, $3: how many rows at most.
template <PageKind kList>
constexpr SqlText PageSql() {
  return {SelectSql(List<kList>::kShape, "uplinkd.").view(), " WHERE ", kSharedIf,
          " AND (ruri, id) > ($1::text, $2::text) ORDER BY ruri, id LIMIT $3::bigint"};
}

/// $1, $2: robots and ids. One look by the key for each, which a limit demands: a join is planned
/// once, while the table may be new and empty, and would then read all rows for each key until the
/// table is analyzed.
template <PageKind kList>
constexpr SqlText OfSql() {
  return {
      "SELECT l.* FROM unnest($1::text[], $2::text[]) AS u (of_ruri, of_id) CROSS JOIN LATERAL (",
      SelectSql(List<kList>::kShape, "uplinkd.").view(),
      " WHERE ruri = of_ruri AND id = of_id AND ", kSharedIf, " LIMIT 1) AS l"};
}

ChangePositions LastOf(const Result& now, const Result& writers) {
  ChangePositions last;
  last.read_at = now.Time(0, 0);
  for (const ResultRow& row : writers) {
    last.writers[row.Uuid(0).bytes()] = {NumberIn(row, 1), row.Time(2)};
  }
  return last;
}

class PostgresSharedItems final : public SharedItems {
 public:
  explicit PostgresSharedItems(std::unique_ptr<OwnConnection> connection)
      : connection_(std::move(connection)) {}

  absl::StatusOr<ChangePositions> Positions() override {
    const auto answers = connection_->Read(PipelineOf(StoreCallOf(kNow), StoreCallOf(kLast)),
                                           "read who changed items");
    if (!answers.ok()) return answers.status();
    return LastOf((*answers)[0], (*answers)[1]);
  }
  absl::StatusOr<SharedChanges> ChangesSince(const ChangePositions& positions) override {
    Array writers{Type::kUuid}, numbers{Type::kInt8};
    for (const auto& [writer, position] : positions.writers) {
      writers.Uuid(model::SessionId(writer));
      numbers.Int8(position.number);
    }
    const auto answers =
        connection_->Read(PipelineOf(StoreCallOf(kNow), StoreCallOf(kLast),
                                     StoreCallOf(kSince, &writers, &numbers, kChangesReadMax)),
                          "read changes of items");
    if (!answers.ok()) return answers.status();
    ChangeWalk walk(positions, LastOf((*answers)[0], (*answers)[1]));
    for (const ResultRow& row : (*answers)[2]) {
      const std::optional<PresentKind> kind = ItemKindOf(row.Int(3));
      if (!kind) return absl::InternalError("a change in the store is of no kind of item");
      walk.Take(row.Uuid(0).bytes(), {NumberIn(row, 1), row.Time(2)},
                {*kind, TextIn(row, 4), TextIn(row, 5)});
    }
    return std::move(walk).Finish();
  }
  absl::StatusOr<SharedPage> Page(const std::optional<ItemKey>& after) override {
    return GatherPage(after, [this]<PageKind kList>(const ItemKey& from, GatheredPage& gathered) {
      return Gather<kList>(from, gathered);
    });
  }
  absl::StatusOr<std::vector<SharedItem>> Of(std::span<const ItemKey> keys) override {
    std::vector<SharedItem> items;
    absl::Status found = LookUp<PageKind::kShapes>(PresentKind::kShape, keys, items);
    if (found.ok()) found = LookUp<PageKind::kObjects>(PresentKind::kObject, keys, items);
    if (!found.ok()) return found;
    return items;
  }

 private:
  template <PageKind kList>
  absl::Status Gather(ItemKey after, GatheredPage& gathered) {
    static constexpr SqlText kSql = PageSql<kList>();
    const std::vector<SharedItem>& items = gathered.page.items;
    std::int64_t chunk = kFirstChunkRows;
    while (!gathered.full()) {
      const std::int64_t asked =
          std::min(chunk, static_cast<std::int64_t>(kSharedPageMax - items.size()));
      const auto rows = connection_->Read(StoreCallOf(kSql.view(), after.ruri, after.id, asked),
                                          "read shared items");
      if (!rows.ok()) return rows.status();
      for (const ResultRow& row : *rows) {
        if (gathered.full()) break;
        gathered.Add({ReadRow<kList>(row)}, row.TextBytes());
      }
      if (rows->rows() < asked && !gathered.full()) return absl::OkStatus();
      after = items.back().Key();
      chunk = NextChunkRows(items.size(), gathered.bytes);
    }
    gathered.page.more = true;
    return absl::OkStatus();
  }

  /// Adds those of the keys of one kind that are there.
  template <PageKind kList>
  absl::Status LookUp(PresentKind kind, std::span<const ItemKey> keys,
                      std::vector<SharedItem>& items) {
    static constexpr SqlText kSql = OfSql<kList>();
    auto key = keys.begin();
    while (true) {
      Array robots{Type::kText}, ids{Type::kText};
      for (; key != keys.end() && robots.size() < kKeysPerStatement; ++key) {
        if (key->kind != kind) continue;
        robots.Text(key->ruri);
        ids.Text(key->id);
      }
      if (robots.size() == 0) return absl::OkStatus();
      const auto rows =
          connection_->Read(StoreCallOf(kSql.view(), &robots, &ids), "look shared items up");
      if (!rows.ok()) return rows.status();
      for (const ResultRow& row : *rows) items.push_back({ReadRow<kList>(row)});
    }
  }

  const std::unique_ptr<OwnConnection> connection_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<SharedItems>> MakeSharedItems(const StoreOptions& options,
                                                             const Clock& clock) {
  return MakeOverOwn<PostgresSharedItems>(options, clock);
}

}  // namespace uplink::storage::postgres
