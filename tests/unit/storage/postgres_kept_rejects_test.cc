// Which rows of kept Rejects go with an opening, and that it looks for them by their key.
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/base/clock.h"
#include "storage/bounds.h"
#include "storage/postgres/link/connection.h"
#include "storage/postgres/link/link.h"
#include "storage/postgres/write/open_calls.h"
#include "tests/unit/storage/postgres_fixture.h"

namespace uplink::storage::postgres {
namespace {

using ::testing::HasSubstr;

class PostgresKeptRejects : public PostgresFixture {
 protected:
  void SetUp() override { store_ = Store(); }
  OpenRequest Request(std::uint8_t session, model::Seq settled = 0) {
    return {robot_, Session(session), settled, FromUnixMs(++now_ms_), {}};
  }
  void Open(std::uint8_t session, model::Seq settled = 0) {
    held_since_ = PostgresFixture::Open(*store_, Request(session, settled)).held_since;
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
  std::string Rows() {
    return database_.Shell().Read(
        "SELECT left(session::text, 2), string_agg(last::text, ',' ORDER BY last)"
        " FROM uplinkd.kept_rejects GROUP BY session ORDER BY session");
  }
  static model::SessionId Session(std::uint8_t number) { return model::SessionId({number}); }

  static constexpr ProcessId kProcess = {1};
  std::unique_ptr<PostgresStore> store_;
  Epoch held_since_ = 0;
  std::int64_t now_ms_ = kNowMs;
};

TEST_F(PostgresKeptRejects, WhatItsOwnHelloConfirmedGoes) {
  OpenAndKeep(1);
  OpenAndKeep(2);
  Open(1, 2);
  EXPECT_EQ(Rows(), "01|3,4\n02|3,4\n") << "3 is not confirmed";
  Open(1, 3);
  EXPECT_EQ(Rows(), "01|4\n02|3,4\n");
  Open(2, 100);
  EXPECT_EQ(Rows(), "01|4\n");
}

TEST_F(PostgresKeptRejects, ThoseOfAnEvictedSessionGoWithIt) {
  OpenAndKeep(1);
  OpenAndKeep(2);
  for (std::uint8_t i = 2; i <= kSessionsPerRobotMax; ++i) {
    EXPECT_EQ(Rows(), "01|3,4\n02|3,4\n");
    Open(static_cast<std::uint8_t>(i + 100));
  }
  EXPECT_EQ(Rows(), "02|3,4\n");
}

TEST_F(PostgresKeptRejects, ThoseOfAnEarlierSessionOfItsIdGoWhenOneBegins) {
  OpenAndKeep(1);
  database_.Shell().Run("DELETE FROM uplinkd.sessions WHERE ruri <> 'server'");
  Open(2);
  EXPECT_EQ(Rows(), "01|3,4\n");
  Open(1);
  EXPECT_EQ(Rows(), "");
}

// A robot may have 10,000 rows in each of its sessions: an opening reads none but its session's.
TEST_F(PostgresKeptRejects, AreLookedForByTheirKey) {
  std::deque<std::string> texts;  // As long as the connection.
  const auto connection = Connect(SessionSettings(Purpose::kWrite, milliseconds(10'000)));
  const OpenRequest request = Request(1);
  const Wave wave = {{robot_->ruri, 0}};
  std::size_t looked = 0;
  for (StoreCall& call : CallsOf(wave, {&request, 1}, kProcess)) {
    if (call.sql.find("kept_rejects") == std::string_view::npos) continue;
    ++looked;
    const std::string& sql = texts.emplace_back("EXPLAIN (COSTS OFF) " + std::string(call.sql));
    const auto plan = connection->RunOne({sql, std::move(call.parameters)}, "explain");
    ASSERT_TRUE(plan.ok()) << plan.status();
    std::size_t searched = 0;
    for (int row = 0; row < plan->rows(); ++row) {
      const std::string line(plan->Bytes(row, 0));
      if (line.find("Scan") == std::string::npos) continue;
      if (line.find("on kept_rejects") == std::string::npos) continue;
      // The rows that were found are deleted by where they lie.
      if (line.find("Tid Scan") != std::string::npos) continue;
      ++searched;
      EXPECT_THAT(line, HasSubstr("using kept_rejects_pkey")) << sql;
      ASSERT_LT(row + 1, plan->rows());
      EXPECT_THAT(std::string(plan->Bytes(row + 1, 0)), HasSubstr("AND (session = ")) << sql;
    }
    EXPECT_EQ(searched, 1U) << sql;
  }
  EXPECT_EQ(looked, 4U) << "read, counted, evicted, confirmed";
}

}  // namespace
}  // namespace uplink::storage::postgres
