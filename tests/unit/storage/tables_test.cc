#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include <gtest/gtest.h>

#include "storage/tables/lists.h"

namespace uplink::storage {
namespace {

struct Sample {
  std::string key;
  std::int64_t count = 0;
};
struct SampleRow {
  std::string key;
  std::int64_t count = 0;
};

constexpr std::array<Column<Sample, SampleRow>, 3> kColumns = {
    Same("key", [](auto& row) { return &row.key; }).Key(),
    Col("entry", [](const auto& /*row*/) { return Entry(7); }).Kept(),
    Same("count", [](auto& row) { return &row.count; }).Updated("t.count + excluded.count"),
};
constexpr Table<Sample, SampleRow, 3> kAdded = {"added", Writes::kInserts, {}, kColumns};
constexpr Table<Sample, SampleRow, 3> kUpserted = {"upserted", Writes::kUpserts, {}, kColumns};

TEST(TablesTest, AnUpsertReplacesTheValuesOfARowThatIsThereAndKeepsTheRest) {
  EXPECT_EQ(ConflictSql(kAdded).view(), "");
  EXPECT_EQ(ConflictSql(kUpserted).view(),
            " ON CONFLICT (key) DO UPDATE SET count = t.count + excluded.count");
}

TEST(TablesTest, ListsLeaveOutColumnsThatTheyDoNotRead) {
  EXPECT_EQ(ListedColumns(kAdded).view(), "key, count");
  EXPECT_EQ(List<PageKind::kGaps>::kShape.columns, "session, first, last");
  EXPECT_EQ(List<PageKind::kGaps>::kShape.time_column, "seen_at");
  EXPECT_EQ(List<PageKind::kEvents>::kShape.columns, "sampled_ms, kind, detail");
  EXPECT_TRUE(List<PageKind::kQuarantine>::kShape.columns.starts_with("session, seq, reason"));
}

TEST(TablesTest, AValueReadsBackAsItWasWritten) {
  const Sample sample = {"a", -3};
  SampleRow row;
  for (const auto& column : kColumns) {
    if (column.take) (*column.take)(column.value(sample), row);
  }
  EXPECT_EQ(row.key, "a");
  EXPECT_EQ(row.count, -3);
  EXPECT_EQ(std::get<std::int64_t>(kColumns[1].value(sample)), 7);
}

TEST(TablesTest, TheTypeOfAColumnFollowsFromItsValue) {
  EXPECT_EQ(kColumns[0].type, ColumnType::kText);
  EXPECT_EQ(kColumns[1].type, ColumnType::kEntry);
  EXPECT_EQ(kColumns[2].type, ColumnType::kInt8);
  EXPECT_EQ(ColumnTypeOf<std::optional<Bytes>>(), ColumnType::kBytes);
  EXPECT_EQ(ColumnTypeOf<model::FaultSeverity>(), ColumnType::kInt4);
  EXPECT_EQ(ColumnTypeOf<std::uint32_t>(), ColumnType::kInt8);
}

TEST(TablesTest, AHistoryTakesTheReportsOfItsKindAlone) {
  EXPECT_EQ(HistoryOf<model::EventTelemetry>(), PageKind::kEvents);
  EXPECT_EQ(HistoryOf<model::Message>(), PageKind::kMessages);
  EXPECT_EQ(HistoryOf<model::AgentInfo>(), std::nullopt);
}

TEST(TablesTest, ARunHasTheNameThatAReportGaveLast) {
  model::MissionRunStatus named;
  named.name = "north";
  const model::MissionRunStatus bare;
  MissionRun run({nullptr, &bare, "1", 1});
  EXPECT_EQ(run.name, std::nullopt);
  run.Add({nullptr, &named, "2", 2});
  run.Add({nullptr, &bare, "3", 3});
  EXPECT_EQ(run.name, "north");
  EXPECT_EQ(run.updates, 3U);
  EXPECT_EQ(run.first.entry.number, 1);
  EXPECT_EQ(run.last.json, "3");
}

}  // namespace
}  // namespace uplink::storage
