#include "storage/postgres/shared_items.h"

#include <algorithm>
#include <string>
#include <utility>

#include "schema/base/check.h"
#include "storage/change_walk.h"
#include "storage/gathered_page.h"
#include "storage/postgres/own_connection.h"
#include "storage/postgres/read/lists.h"

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

/// What ReadRow<kList> reads.
template <PageKind kList>
constexpr SqlText SelectSql() {
  return {"SELECT ",
          List<kList>::kTable.listed.time_column,
          ", entry, ruri, fleet, ",
          List<kList>::kColumns.view(),
          " FROM uplinkd.",
          List<kList>::kTable.name};
}

/// $1, $2: after which robot and id, $3: how many rows at most.
template <PageKind kList>
constexpr SqlText PageSql() {
  return {SelectSql<kList>().view(), " WHERE ", kSharedIf,
          " AND (ruri, id) > ($1::text, $2::text) ORDER BY ruri, id LIMIT $3::bigint"};
}

/// $1, $2: robots and ids. One look by the key for each, which a limit demands: a join is planned
/// once, while the table may be new and empty, and would then read all rows for each key until the
/// table is analyzed.
template <PageKind kList>
constexpr SqlText OfSql() {
  return {
      "SELECT l.* FROM unnest($1::text[], $2::text[]) AS u (of_ruri, of_id) CROSS JOIN LATERAL (",
      SelectSql<kList>().view(), " WHERE ruri = of_ruri AND id = of_id AND ", kSharedIf,
      " LIMIT 1) AS l"};
}

ChangePositions LastOf(const std::vector<Result>& answers) {
  ChangePositions last;
  last.read_at = answers[0].Time(0, 0);
  const Result& rows = answers[1];
  for (int row = 0; row < rows.rows(); ++row) {
    last.writers[rows.Uuid(row, 0).bytes()] = {static_cast<std::uint64_t>(rows.Int(row, 1)),
                                               rows.Time(row, 2)};
  }
  return last;
}

absl::StatusOr<SharedChanges> ChangesOf(const ChangePositions& from,
                                        const std::vector<Result>& answers) {
  ChangeWalk walk(from, LastOf(answers));
  const Result& rows = answers[2];
  for (int row = 0; row < rows.rows(); ++row) {
    const std::optional<PresentKind> kind = ItemKindOf(rows.Int(row, 3));
    if (!kind) return absl::InternalError("a change in the store is of no kind of item");
    walk.Take(rows.Uuid(row, 0).bytes(),
              {static_cast<std::uint64_t>(rows.Int(row, 1)), rows.Time(row, 2)},
              {*kind, std::string(rows.Bytes(row, 4)), std::string(rows.Bytes(row, 5))});
  }
  return std::move(walk).Finish();
}

template <PageKind kList>
absl::Status Gather(OwnConnection& connection, ItemKey after, GatheredPage& gathered) {
  static constexpr SqlText kSql = PageSql<kList>();
  const std::vector<SharedItem>& items = gathered.page.items;
  std::int64_t chunk = kFirstChunkRows;
  while (!gathered.full()) {
    const std::int64_t asked =
        std::min(chunk, static_cast<std::int64_t>(kSharedPageMax - items.size()));
    std::vector<StoreCall> calls;
    Parameters& parameters = calls.emplace_back(StoreCall{kSql.view(), {}}).parameters;
    parameters.Text(after.ruri);
    parameters.Text(after.id);
    parameters.Int8(asked);
    const auto answers = connection.Read(calls, "read shared items");
    if (!answers.ok()) return answers.status();
    const Result& rows = answers->front();
    for (int row = 0; row < rows.rows(); ++row) {
      if (gathered.full()) break;
      gathered.Add({ReadRow<kList>(rows, row)}, rows.RowBytes(row));
    }
    if (rows.rows() < asked && !gathered.full()) return absl::OkStatus();
    after = items.back().Key();
    chunk = NextChunkRows(items.size(), gathered.bytes);
  }
  gathered.page.more = true;
  return absl::OkStatus();
}

/// Adds those of the keys of one kind that are there.
template <PageKind kList>
absl::Status LookUp(OwnConnection& connection, std::span<const ItemKey* const> keys,
                    std::vector<SharedItem>& items) {
  static constexpr SqlText kSql = OfSql<kList>();
  while (!keys.empty()) {
    const auto some = keys.first(std::min(keys.size(), kKeysPerStatement));
    keys = keys.subspan(some.size());
    Array robots{Type::kText}, ids{Type::kText};
    for (const ItemKey* const key : some) {
      robots.Text(key->ruri);
      ids.Text(key->id);
    }
    std::vector<StoreCall> calls;
    calls.push_back(StoreCallOf(kSql.view(), {&robots, &ids}));
    const auto answers = connection.Read(calls, "look shared items up");
    if (!answers.ok()) return answers.status();
    const Result& rows = answers->front();
    for (int row = 0; row < rows.rows(); ++row) {
      items.push_back({ReadRow<kList>(rows, row)});
    }
  }
  return absl::OkStatus();
}

struct KeysByKind {
  std::vector<const ItemKey*> shapes;
  std::vector<const ItemKey*> objects;

  std::vector<const ItemKey*>& Of(PresentKind kind) {
    switch (kind) {
      case PresentKind::kShape:
        return shapes;
      case PresentKind::kObject:
        return objects;
      case PresentKind::kFault:
        break;
    }
    CheckFailed(__FILE__, __LINE__, "ItemNumberOf(kind)", "the key of an item");
  }
};

KeysByKind ByKind(std::span<const ItemKey> keys) {
  KeysByKind by_kind;
  for (const ItemKey& key : keys) by_kind.Of(key.kind).push_back(&key);
  return by_kind;
}

}  // namespace

struct PostgresSharedItems::Impl {
  std::unique_ptr<OwnConnection> connection;
};

PostgresSharedItems::PostgresSharedItems(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PostgresSharedItems::~PostgresSharedItems() = default;

absl::StatusOr<std::unique_ptr<PostgresSharedItems>> PostgresSharedItems::Make(
    const StoreOptions& options, const Clock& clock) {
  absl::StatusOr<std::unique_ptr<OwnConnection>> connection = OwnConnection::Make(options, clock);
  if (!connection.ok()) return connection.status();
  return std::unique_ptr<PostgresSharedItems>(
      new PostgresSharedItems(std::make_unique<Impl>(Impl{*std::move(connection)})));
}

absl::StatusOr<ChangePositions> PostgresSharedItems::Positions() {
  const auto answers = impl_->connection->Read({{kNow, {}}, {kLast, {}}}, "read who changed items");
  if (!answers.ok()) return answers.status();
  return LastOf(*answers);
}

absl::StatusOr<SharedChanges> PostgresSharedItems::ChangesSince(const ChangePositions& positions) {
  Array writers{Type::kUuid}, numbers{Type::kInt8};
  for (const auto& [writer, position] : positions.writers) {
    writers.Uuid(model::SessionId(writer));
    numbers.Int8(position.number);
  }
  std::vector<StoreCall> calls = {{kNow, {}}, {kLast, {}}};
  calls.push_back(StoreCallOf(kSince, {&writers, &numbers}));
  calls.back().parameters.Int8(static_cast<std::int64_t>(kChangesReadMax));
  const auto answers = impl_->connection->Read(calls, "read changes of items");
  if (!answers.ok()) return answers.status();
  return ChangesOf(positions, *answers);
}

absl::StatusOr<SharedPage> PostgresSharedItems::Page(const std::optional<ItemKey>& after) {
  ItemKey start = after.value_or(ItemKey{});
  GatheredPage gathered;
  absl::Status read;
  // Each kind goes on with the next one, from its beginning.
  switch (start.kind) {
    case PresentKind::kShape:
      read = Gather<PageKind::kShapes>(*impl_->connection, start, gathered);
      if (!read.ok() || gathered.page.more) break;
      start = {};
      [[fallthrough]];
    case PresentKind::kObject:
      read = Gather<PageKind::kObjects>(*impl_->connection, start, gathered);
      break;
    case PresentKind::kFault:
      UPLINK_CHECK(false, "the key of an item");
  }
  if (!read.ok()) return read;
  return std::move(gathered.page);
}

absl::StatusOr<std::vector<SharedItem>> PostgresSharedItems::Of(std::span<const ItemKey> keys) {
  const KeysByKind by_kind = ByKind(keys);
  std::vector<SharedItem> items;
  absl::Status found = LookUp<PageKind::kShapes>(*impl_->connection, by_kind.shapes, items);
  if (found.ok()) found = LookUp<PageKind::kObjects>(*impl_->connection, by_kind.objects, items);
  if (!found.ok()) return found;
  return items;
}

}  // namespace uplink::storage::postgres
