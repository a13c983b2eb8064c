#include <optional>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "storage/sqlite/lists.h"
#include "storage/sqlite/tables/latest.h"
#include "storage/sqlite/tables/lists.h"

namespace uplink::storage::sqlite {
namespace {

struct Sample {
  std::string key;
  std::int64_t count = 0;
};

constexpr auto kSampleColumns = std::to_array<Column<Sample, Unlisted>>({
    {"key", Role::kKey, [](Binder& to, const Sample& row) { to.Text(row.key); },
     [](const Cell& /*cell*/, Unlisted& /*row*/) {}},
    {"entry", Role::kKept, [](Binder& to, const Sample& /*row*/) { to.Int(1); }, std::nullopt,
     "? + 1"},
    {"seen", Role::kValue, [](Binder& to, const Sample& row) { to.Int(row.count); },
     [](const Cell& /*cell*/, Unlisted& /*row*/) {}},
    {"count",
     Role::kValue,
     [](Binder& to, const Sample& row) { to.Int(row.count); },
     std::nullopt,
     {},
     "count + excluded.count"},
});
constexpr Table<Sample, Unlisted, 4> kAdded = {"added", Writes::kInserts, {}, kSampleColumns};
constexpr Table<Sample, Unlisted, 4> kUpserted = {"upserted", Writes::kUpserts, {}, kSampleColumns};

TEST(SqliteInsertSql, NamesEachColumnInTheOrderOfItsParameters) {
  EXPECT_EQ(InsertSql(kAdded).view(),
            "INSERT INTO added (key, entry, seen, count) VALUES (?, ? + 1, ?, ?)");
}

TEST(SqliteInsertSql, ReplacesTheValuesOfARowThatIsThereAndKeepsTheRest) {
  const std::string sql(InsertSql(kUpserted).view());
  EXPECT_TRUE(
      sql.ends_with(" ON CONFLICT (key) DO UPDATE SET seen = excluded.seen,"
                    " count = count + excluded.count"))
      << sql;
}

// The update of a run's name goes by its own parameter, which it names by number.
TEST(SqliteInsertSql, NamesOfRunsAreTheParameterThatTheirUpdateMeans) {
  std::size_t number = 0;
  while (kMissionRunsTable.columns.at(number).name != "name") ++number;
  EXPECT_EQ(kMissionRunsTable.columns.at(number).update,
            "coalesce(?" + std::to_string(number + 1) + ", name)");
}

TEST(SqliteLists, LeaveOutColumnsThatNoListReads) {
  EXPECT_EQ(ListedColumns(kAdded).view(), "key, seen");
  EXPECT_EQ(List<PageKind::kGaps>::kShape.columns, "session, first, last");
  EXPECT_EQ(List<PageKind::kGaps>::kShape.time_column, "seen_at");
}

TEST(SqliteLists, AHistoryTakesTheReportsOfItsKindAlone) {
  EXPECT_EQ(HistoryOf<model::EventTelemetry>(), PageKind::kEvents);
  EXPECT_EQ(HistoryOf<model::Message>(), PageKind::kMessages);
  EXPECT_EQ(HistoryOf<model::AgentInfo>(), std::nullopt);
}

}  // namespace
}  // namespace uplink::storage::sqlite
