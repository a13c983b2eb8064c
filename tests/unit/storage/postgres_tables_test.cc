#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "storage/postgres/read/lists.h"
#include "storage/postgres/tables/present_sql.h"
#include "storage/postgres/tables/set_aside.h"
#include "storage/postgres/tables/table.h"

namespace uplink::storage::postgres {
namespace {

struct Sample {
  std::string key;
  std::int64_t count = 0;
};

constexpr auto kSampleColumns = std::to_array<Column<Sample, Unlisted>>({
    {"key", Type::kText, Role::kKey, [](Array& to, const Sample& row) { to.Text(row.key); },
     [](const Cell& /*cell*/, Unlisted& /*row*/) {}},
    {"entry", Type::kInt4, Role::kKept, [](Array& to, const Sample& /*row*/) { to.Int4(1); },
     std::nullopt, "entry + 1"},
    {"seen", Type::kInt8, Role::kValue, [](Array& to, const Sample& row) { to.Int8(row.count); },
     [](const Cell& /*cell*/, Unlisted& /*row*/) {}},
    {"count",
     Type::kInt8,
     Role::kValue,
     [](Array& to, const Sample& row) { to.Int8(row.count); },
     std::nullopt,
     {},
     "t.count + excluded.count"},
});
constexpr Table<Sample, Unlisted, 4> kAdded = {"added", Writes::kInserts, {}, kSampleColumns};
constexpr Table<Sample, Unlisted, 4> kUpserted = {"upserted", Writes::kUpserts, {}, kSampleColumns};

TEST(InsertSql, NamesEachColumnInTheOrderOfItsParameters) {
  EXPECT_EQ(InsertSql(kAdded).view(),
            "INSERT INTO uplinkd.added AS t (key, entry, seen, count)"
            " SELECT key, entry + 1, seen, count"
            " FROM unnest($1::text[], $2::int[], $3::bigint[], $4::bigint[])"
            " AS u (key, entry, seen, count)");
}

TEST(InsertSql, ReplacesTheValuesOfARowThatIsThereAndKeepsTheRest) {
  const std::string sql(InsertSql(kUpserted).view());
  EXPECT_TRUE(
      sql.ends_with(" ON CONFLICT (key) DO UPDATE SET seen = excluded.seen,"
                    " count = t.count + excluded.count"))
      << sql;
}

TEST(InsertSql, CountsPastNineParameters) {
  EXPECT_NE(InsertSql(kQuarantineTable).view().find("$9::text[], $10::bigint[], $11::bytea[]"),
            std::string_view::npos);
}

TEST(ListedColumns, LeaveOutWhatNoListReads) {
  EXPECT_EQ(ListedColumns(kAdded).view(), "key, seen");
  EXPECT_EQ(List<PageKind::kGaps>::kShape.columns, "session, first, last");
  EXPECT_EQ(List<PageKind::kGaps>::kShape.time_column, "seen_at");
}

TEST(AddInsert, FillsEveryColumnOnceForEachRow) {
  std::vector<StoreCall> calls;
  AddInsert<kAdded>(std::vector<Sample>{{"a", 1}, {"b", 2}}, calls);
  ASSERT_EQ(calls.size(), 1U);
  EXPECT_EQ(calls[0].sql, InsertSql(kAdded).view());
  ASSERT_EQ(calls[0].parameters.values().size(), 4U);
  Array counts(Type::kInt8);
  counts.Int8(std::int64_t{1});
  counts.Int8(std::int64_t{2});
  EXPECT_EQ(calls[0].parameters.values()[3], std::move(counts).Take());
}

TEST(AddInsert, AddsNothingWithoutRows) {
  std::vector<StoreCall> calls;
  AddInsert<kAdded>(std::vector<Sample>{}, calls);
  EXPECT_TRUE(calls.empty());
}

TEST(PresentSqlTest, DiffersByTheRowOfTheKind) {
  EXPECT_EQ(PresentSqlOf(PresentKind::kFault).remove.view(),
            "DELETE FROM uplinkd.faults_active AS t"
            " USING unnest($1::text[], $2::text[], $3::text[]) AS u (ruri, id, source)"
            " WHERE t.ruri = u.ruri AND t.fault_id = u.id AND t.source = u.source");
  EXPECT_EQ(PresentSqlOf(PresentKind::kObject).remove.view(),
            "DELETE FROM uplinkd.objects AS t"
            " USING unnest($1::text[], $2::text[], $3::bigint[]) AS u (ruri, id, by_ms)"
            " WHERE t.ruri = u.ruri AND t.id = u.id AND (u.by_ms = 9223372036854775807"
            " OR (t.expires_ms <> 0 AND t.expires_ms <= u.by_ms))");
  EXPECT_EQ(PresentSqlOf(PresentKind::kShape).read.view(),
            "SELECT t.ruri, t.id, ''::text, t.expires_ms"
            " FROM unnest($1::text[], $2::text[]) AS u (ruri, id)"
            " JOIN uplinkd.shapes AS t ON t.ruri = u.ruri AND t.id = u.id");
}

}  // namespace
}  // namespace uplink::storage::postgres
