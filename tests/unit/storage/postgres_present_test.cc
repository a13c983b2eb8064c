// What a batch reads of what is present of its robots: the entries that it names, and no more.
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
#include "storage/postgres/tables/present_sql.h"
#include "storage/postgres/write/known.h"
#include "storage/postgres/write/transaction.h"
#include "tests/support/records.h"
#include "tests/unit/storage/postgres_fixture.h"

namespace uplink::storage::postgres {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Key;

/// A robot at its bound of shapes: `s1`, `s2`, ...; each expires a millisecond after the
/// one before, the first at kNowMs + kLifeMs.
class PostgresPresent : public PostgresFixture {
 protected:
  static constexpr ProcessId kProcess = {1};
  static constexpr std::int64_t kLifeMs = 60'000;

  void SetUp() override {
    rules_.clock = &trust_;
    held_since_ = Open(*Store()).held_since;
    database_.Shell().Run(
        "INSERT INTO uplinkd.shapes (ruri, id, fleet, first_at, entry, received_at, expires_ms, "
        "name,"
        " rev, hash, area_type, scope, min_z_m, max_z_m, level_id, geometry)"
        " SELECT 'rcan://robots/a', 's' || i, 'f1', now(), i, now(), " +
        std::to_string(kNowMs + kLifeMs - 1) + " + i, '', 0, '', 0, 0, 0, 0, 0, '{}'" +
        " FROM generate_series(1, " + std::to_string(kShapesPerRobotMax) + ") AS s (i)");
    connection_ = Connect(SessionSettings(Purpose::kWrite, milliseconds(10'000)));
  }

  /// What is known for an upsert of this shape that arrives `after_ms`.
  KnownRows::Entries KnownFor(const std::string& id, std::int64_t after_ms) {
    model::ReportedShape shape;
    shape.identity.id = id;
    shape.data = model::GeoPoint2{8.25, 47.5};
    Batch batch;
    batch.records = {{robot_, model::SessionId({1}), 1, held_since_, FromUnixMs(kNowMs + after_ms),
                      test::RecordOf(model::ShapeOp{std::move(shape)}), "", 0}};
    EXPECT_TRUE(Begin(*connection_, "test").ok());
    auto known = ReadKnown(*connection_, {&batch, 0, 1, true}, {kProcess, rules_});
    EXPECT_TRUE(known.ok()) << known.status();
    EXPECT_TRUE(connection_->RollBack().ok());
    if (!known.ok()) return {};
    EXPECT_EQ(
        known->robots.at(robot_->ruri).counts.at(static_cast<std::size_t>(PresentKind::kShape)),
        kShapesPerRobotMax);
    return std::move(known->entries(PresentKind::kShape));
  }
  auto Named(const std::string& id) const {
    return Key(KnownRows::Entry(robot_->ruri, id, std::string()));
  }

  StoreRules rules_;
  std::unique_ptr<Connection> connection_;
  Epoch held_since_ = 0;
};

// The finding: each batch of the robot's shard read all 10,000 rows.
TEST_F(PostgresPresent, OfARobotAtItsBoundABatchReadsWhatItNames) {
  EXPECT_THAT(KnownFor("s7", 0), ElementsAre(Named("s7")));
  EXPECT_THAT(KnownFor("new", kLifeMs - 1), IsEmpty());
}

TEST_F(PostgresPresent, AtItsBoundWhatHasExpiredIsReadToo) {
  EXPECT_THAT(KnownFor("new", kLifeMs), ElementsAre(Named("s1")));
  EXPECT_THAT(KnownFor("s7", kLifeMs + 2),
              ElementsAre(Named("s1"), Named("s2"), Named("s3"), Named("s7")));
  trust_.Set(false);
  EXPECT_THAT(KnownFor("new", kLifeMs + 2), IsEmpty()) << "by a clock that is not vouched for";
}

TEST_F(PostgresPresent, WhatHasExpiredIsFoundByItsRobotAndTime) {
  // Other robots have some, too, or the index of times alone would do.
  database_.Shell().Run(
      "INSERT INTO uplinkd.shapes SELECT 'rcan://robots/b' || entry % 20, id, fleet, first_at, "
      "entry,"
      " received_at, expires_ms, name, rev, hash, area_type, scope, min_z_m, max_z_m, level_id,"
      " geometry FROM uplinkd.shapes");
  database_.Shell().Run("ANALYZE uplinkd.shapes");
  const std::string sql =  // As long as the connection: it goes first.
      "EXPLAIN (COSTS OFF) " + std::string(PresentSqlOf(PresentKind::kShape).expired.view());
  Array ruri{Type::kText}, upserts{Type::kInt4}, by_ms{Type::kInt8};
  ruri.Text(robot_->ruri);
  upserts.Int4(1);
  by_ms.Int8(kNowMs);
  const auto answer =
      connection_->RunOne(StoreCallOf(sql, &ruri, &upserts, &by_ms, std::int64_t{1}), "explain");
  ASSERT_TRUE(answer.ok()) << answer.status();
  std::string plan;
  for (const ResultRow& row : *answer) plan += std::string(row.Bytes(0)) + "\n";
  // Whether any has.
  EXPECT_THAT(plan, HasSubstr("using shapes_by_robot_and_expiry"));
  connection_.reset();
}

}  // namespace
}  // namespace uplink::storage::postgres
