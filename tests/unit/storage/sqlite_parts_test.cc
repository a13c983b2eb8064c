#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "storage/sqlite/errors.h"
#include "storage/sqlite/pages.h"
#include "storage/sqlite/store.h"
#include "tests/support/sqlite_shell.h"
#include "tests/support/temp_folder.h"
#include "tests/unit/storage/filter_cases.h"

namespace uplink::storage::sqlite {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr ListShape kMissionRuns = List<PageKind::kMissionRuns>::kShape;
constexpr ListShape kMissionReports = List<PageKind::kMissionReports>::kShape;
constexpr ListShape kShapes = List<PageKind::kShapes>::kShape;
constexpr ListShape kObjects = List<PageKind::kObjects>::kShape;
constexpr std::string_view kOpenColumn = kMissionRunsTable.listed.open_column;

TEST(SqliteErrors, SortsEveryCodeThatACallMayGive) {
  EXPECT_EQ(DispositionOf(SQLITE_BUSY), Disposition::kRetry);
  EXPECT_EQ(DispositionOf(SQLITE_BUSY_SNAPSHOT), Disposition::kRetry);
  EXPECT_EQ(DispositionOf(SQLITE_LOCKED), Disposition::kRetry);
  EXPECT_EQ(DispositionOf(SQLITE_IOERR_FSYNC), Disposition::kRetry);
  EXPECT_EQ(DispositionOf(SQLITE_CANTOPEN), Disposition::kRetry);
  EXPECT_EQ(DispositionOf(SQLITE_FULL), Disposition::kFull);
  EXPECT_EQ(DispositionOf(SQLITE_NOMEM), Disposition::kFull);
  EXPECT_EQ(DispositionOf(SQLITE_IOERR_NOMEM), Disposition::kRetry);
  EXPECT_EQ(DispositionOf(SQLITE_INTERRUPT), Disposition::kTooLong);
  EXPECT_EQ(DispositionOf(SQLITE_CONSTRAINT_CHECK), Disposition::kRefuseRow);
  EXPECT_EQ(DispositionOf(SQLITE_TOOBIG), Disposition::kRefuseRow);
  EXPECT_EQ(DispositionOf(SQLITE_CORRUPT), Disposition::kDamage);
  EXPECT_EQ(DispositionOf(SQLITE_NOTADB), Disposition::kDamage);
  EXPECT_EQ(DispositionOf(SQLITE_READONLY), Disposition::kStop);
  EXPECT_EQ(DispositionOf(SQLITE_MISUSE), Disposition::kStop);
  EXPECT_EQ(DispositionOf(99), Disposition::kStop);
}

TEST(SqliteErrors, NamesPathStatementAndCode) {
  const absl::Status status = MakeStatus(SQLITE_FULL, "/data/x.db", "COMMIT", "disk is full");
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(std::string(status.message()), "sqlite /data/x.db: COMMIT: disk is full (13)");
  EXPECT_EQ(std::string(MakeStatus(SQLITE_TOOBIG, "/data/x.db", "INSERT", "too big").message()),
            "too big (18)");
}

class SqlitePlans : public ::testing::Test {
 protected:
  void SetUp() override {
    StoreOptions options;
    ASSERT_TRUE(SqliteStore::Open(path_, options).ok());
  }

  /// How SQLite would run the page statement.
  std::string Plan(const ListShape& shape, const HistoryQuery& query,
                   const ListFilter& filter = {}) const {
    return testing::SqliteShell(path_).Read("EXPLAIN QUERY PLAN " + PageSql(shape, query, filter));
  }

  void ExpectOrderOfAnIndex(const ListShape& shape, const ListFilter& filter = {}) const {
    for (const HistoryQuery& query : RobotQueries()) {
      const std::string plan = Plan(shape, query, filter);
      EXPECT_THAT(plan, Not(HasSubstr("TEMP B-TREE"))) << shape.table;
      EXPECT_THAT(plan, HasSubstr("USING INDEX")) << shape.table;
      if (!filter.conditions.empty()) continue;
      if (!query.ruris.empty()) {
        EXPECT_THAT(plan, HasSubstr("(" + std::string(shape.ruri_column) + "=?")) << shape.table;
      } else if (!query.fleets.empty()) {
        EXPECT_THAT(plan, HasSubstr("(fleet=?")) << shape.table;
      }
    }
  }

  testing::TempFolder folder_;
  const std::string path_ = folder_.File("uplinkd.db");
};

TEST_F(SqlitePlans, ReadsEveryListInTheOrderOfAnIndex) {
  ForEachList([this]<PageKind kList>() { ExpectOrderOfAnIndex(List<kList>::kShape); });
  ExpectOrderOfAnIndex(List<PageKind::kAudit>::kShape);
}

TEST_F(SqlitePlans, ReadsWhatAFilterLeavesInTheOrderOfAnIndex) {
  const PresentQuery present{.now = FromUnixMs(1)};
  ExpectOrderOfAnIndex(kShapes, FilterOf(present, ""));
  ExpectOrderOfAnIndex(kObjects, FilterOf(present, ""));
  MissionsQuery mission;
  mission.mission_id = "m";
  MissionsQuery run;
  run.run_id = "r";
  for (const bool open : {false, true}) {
    for (MissionsQuery query : {MissionsQuery{}, mission, run}) {
      query.open = open;
      ExpectOrderOfAnIndex(kMissionRuns, FilterOf(query, kOpenColumn));
    }
  }
  ExpectOrderOfAnIndex(kMissionReports, FilterOf(run, ""));
}

// An open run among a million that have ended, or an expired shape, is found without a scan.
TEST_F(SqlitePlans, FindsOpenRunsAndWhatExpiredByIndexesOfTheirOwn) {
  EXPECT_THAT(Plan(kMissionRuns, {}, FilterOf(MissionsQuery{.open = true}, kOpenColumn)),
              HasSubstr("mission_runs_open_by_time"));
  MissionsQuery run;
  run.run_id = "r";
  EXPECT_THAT(Plan(kMissionRuns, {}, FilterOf(run, kOpenColumn)), HasSubstr("mission_runs_by_run"));
  MissionsQuery mission;
  mission.mission_id = "m";
  EXPECT_THAT(Plan(kMissionRuns, {}, FilterOf(mission, kOpenColumn)),
              HasSubstr("mission_runs_by_mission"));
  mission.rows.ruris = {"r"};
  EXPECT_THAT(Plan(kMissionRuns, mission.rows, FilterOf(mission, kOpenColumn)),
              HasSubstr("mission_runs_by_robot"))
      << "a mission may be a whole fleet's";
}

TEST_F(SqlitePlans, AnswerEveryFilterFromItsIndexAloneAndWithAFleet) {
  for (const FilterCase& one : FilterCases()) {
    SCOPED_TRACE(one.name);
    for (const HistoryQuery& query : RobotQueries()) {
      const bool of_all = query.ruris.empty();
      const std::string plan = Plan(one.shape, query, of_all ? one.filter : one.of_robots);
      EXPECT_THAT(plan, Not(HasSubstr("TEMP B-TREE")));
      EXPECT_THAT(plan, Not(HasSubstr("SCAN")));
      const std::string column(of_all ? one.index : one.shape.ruri_column);
      EXPECT_THAT(plan, HasSubstr("(" + column + "=?"));
    }
  }
}

}  // namespace
}  // namespace uplink::storage::sqlite
