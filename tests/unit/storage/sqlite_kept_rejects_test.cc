// Which rows of kept Rejects go with an opening, and that it looks for them by their key.
#include <memory>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/bounds.h"
#include "storage/sqlite/set_aside_tables.h"
#include "storage/sqlite/store.h"
#include "tests/support/sqlite_shell.h"
#include "tests/support/temp_folder.h"

namespace uplink::storage::sqlite {
namespace {

using ::testing::HasSubstr;

class SqliteKeptRejects : public ::testing::Test {
 protected:
  void SetUp() override {
    auto opened = SqliteStore::Open(path_, StoreOptions());
    ASSERT_TRUE(opened.ok()) << opened.status();
    store_ = *std::move(opened);
  }
  void Open(std::uint8_t session, model::Seq settled = 0) {
    const OpenRequest request{robot_, Session(session), settled, FromUnixMs(++now_ms_), {}};
    const auto results = store_->OpenStreams({&request, 1});
    ASSERT_TRUE(results.ok()) << results.status();
    held_since_ = results->front().held_since;
  }
  /// Numbers 1 to 3 of the session in one row, 4 in a row of its own.
  void OpenAndKeep(std::uint8_t session) {
    Open(session);
    const model::Rejection reason{model::RejectReason::kRateLimited, "", "too many"};
    Batch batch;
    batch.records = {{robot_, Session(session), 3, held_since_, FromUnixMs(now_ms_),
                      LimitedRange{1, reason}, "", 0},
                     {robot_, Session(session), 4, held_since_, FromUnixMs(now_ms_),
                      LimitedRange{4, reason}, "", 0}};
    ASSERT_TRUE(store_->Commit(batch).ok());
  }
  /// The last numbers of the rows, session after session.
  std::string Rows() const {
    return testing::SqliteShell(path_).Read(
        "SELECT session, group_concat(last, ',') FROM (SELECT hex(substr(session, 1, 1)) AS "
        "session,"
        " last FROM kept_rejects ORDER BY 1, 2) GROUP BY 1");
  }
  std::string Plan(std::string_view sql) const {
    return testing::SqliteShell(path_).Read("EXPLAIN QUERY PLAN " + std::string(sql));
  }
  static model::SessionId Session(std::uint8_t number) { return model::SessionId({number}); }

  testing::TempFolder folder_;
  const std::string path_ = folder_.File("uplinkd.db");
  std::unique_ptr<SqliteStore> store_;
  const RobotRef robot_ =
      std::make_shared<const model::RobotId>(model::RobotId{"rcan://robots/a", "f1"});
  Epoch held_since_ = 0;
  std::int64_t now_ms_ = 1'763'683'200'000;
};

TEST_F(SqliteKeptRejects, WhatItsOwnHelloConfirmedGoes) {
  OpenAndKeep(1);
  OpenAndKeep(2);
  Open(1, 2);
  EXPECT_EQ(Rows(), "01|3,4\n02|3,4\n") << "3 is not confirmed";
  Open(1, 3);
  EXPECT_EQ(Rows(), "01|4\n02|3,4\n");
  Open(2, 100);
  EXPECT_EQ(Rows(), "01|4\n");
}

TEST_F(SqliteKeptRejects, ThoseOfAnEvictedSessionGoWithIt) {
  OpenAndKeep(1);
  OpenAndKeep(2);
  for (std::uint8_t i = 2; i <= kSessionsPerRobotMax; ++i) {
    EXPECT_EQ(Rows(), "01|3,4\n02|3,4\n");
    Open(static_cast<std::uint8_t>(i + 100));
  }
  EXPECT_EQ(Rows(), "02|3,4\n");
}

TEST_F(SqliteKeptRejects, ThoseOfAnEarlierSessionOfItsIdGoWhenOneBegins) {
  OpenAndKeep(1);
  testing::SqliteShell(path_).Run("DELETE FROM sessions");
  Open(2);
  EXPECT_EQ(Rows(), "01|3,4\n");
  Open(1);
  EXPECT_EQ(Rows(), "");
}

// A robot may have 10,000 rows in each of its sessions: an opening reads none but its session's.
TEST_F(SqliteKeptRejects, AreLookedForByTheirKey) {
  EXPECT_THAT(Plan(kForgetKeptSql),
              HasSubstr("SEARCH kept_rejects USING PRIMARY KEY (ruri=? AND session=? AND last<?)"));
  for (const std::string_view sql : {kCountRejectsSql, kRejectsSql}) {
    const std::string plan = Plan(sql);
    EXPECT_THAT(
        plan, HasSubstr("SEARCH kept_rejects USING PRIMARY KEY (ruri=? AND session=? AND last>?)"));
    EXPECT_THAT(plan, ::testing::Not(HasSubstr("SCAN kept_rejects")));
  }
}

}  // namespace
}  // namespace uplink::storage::sqlite
