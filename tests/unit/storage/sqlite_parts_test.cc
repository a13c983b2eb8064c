#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "storage/sqlite/errors.h"
#include "storage/sqlite/pages.h"
#include "storage/sqlite/store.h"
#include "tests/support/sqlite_shell.h"
#include "tests/support/temp_folder.h"

namespace uplink::storage::sqlite {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

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
  EXPECT_EQ(DispositionOf(SQLITE_CORRUPT), Disposition::kStop);
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
  std::string Plan(const ListShape& shape, const HistoryQuery& query) const {
    return testing::SqliteShell(path_).Read("EXPLAIN QUERY PLAN " + PageSql(shape, query));
  }

  testing::TempFolder folder_;
  const std::string path_ = folder_.File("uplinkd.db");
};

// NOLINTNEXTLINE(readability-function-size): one table of queries
TEST_F(SqlitePlans, ReadsEveryListInTheOrderOfAnIndex) {
  const ListShape shapes[] = {
      {PageKind::kFaultHistory, "faults_history", "seq", "received_ms"},
      {PageKind::kFaultsActive, "faults_active", "fault_id", "raised_ms"},
      {PageKind::kQuarantine, "quarantine", "seq", "received_ms"},
      {PageKind::kGaps, "gaps", "first", "seen_ms"},
  };
  HistoryQuery all;
  HistoryQuery fleet;
  fleet.fleet = "f";
  HistoryQuery robot;
  robot.ruri = "r";
  HistoryQuery both = robot;
  both.fleet = "f";
  for (const ListShape& shape : shapes) {
    for (HistoryQuery query : {all, fleet, robot, both}) {
      for (const bool later_page : {false, true}) {
        query.page_token = later_page ? "x" : "";
        const std::string plan = Plan(shape, query);
        EXPECT_THAT(plan, Not(HasSubstr("TEMP B-TREE"))) << shape.table;
        EXPECT_THAT(plan, HasSubstr("USING INDEX")) << shape.table;
        if (!query.ruri.empty()) {
          EXPECT_THAT(plan, HasSubstr("(ruri=?")) << shape.table;
        } else if (!query.fleet.empty()) {
          EXPECT_THAT(plan, HasSubstr("(fleet=?")) << shape.table;
        }
      }
    }
  }
}

}  // namespace
}  // namespace uplink::storage::sqlite
