// How days of quarantine go: by slices, while others write.
#include <future>
#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "schema/base/clock.h"
#include "storage/bounds.h"
#include "tests/support/eventually.h"
#include "tests/unit/storage/postgres_fixture.h"

namespace uplink::storage::postgres {
namespace {

using testing::Eventually;

class PostgresQuarantineDays : public PostgresFixture {
 protected:
  void SetUp() override {
    store_ = Store();
    Open(*store_);
    shell_.Run("UPDATE uplinkd.sessions SET cursor_seq = 100000, first_entry = 1 WHERE ruri = '" +
               robot_->ruri + "'");
  }
  /// Numbers of the session, all of one time of the day that goes.
  static std::string InsertSql(std::size_t first, std::size_t last,
                               const std::string& time = "12:00") {
    return "INSERT INTO uplinkd.quarantine (ruri, session, seq, entry, received_at, fleet, reason,"
           " field, detail, payload_bytes)"
           " SELECT 'rcan://robots/a', '07000000-0000-0000-0000-000000000000', n, n,"
           " '2025-11-21 " +
           time + "Z', 'f1', 1, '', '', 0 FROM generate_series(" + std::to_string(first) + ", " +
           std::to_string(last) + ") AS n";
  }
  Erased Retain() {
    const auto erased = store_->Retain(clock_.System());
    EXPECT_TRUE(erased.ok()) << erased.status();
    return erased.value_or(Erased());
  }
  std::string Days() {
    return shell_.Read("SELECT count(*) FROM pg_class WHERE relname = 'quarantine_20251121'");
  }
  std::string Rows(const std::string& table) {
    return shell_.Read("SELECT count(*) FROM uplinkd." + table);
  }

  std::unique_ptr<PostgresStore> store_;
};

TEST_F(PostgresQuarantineDays, ACallTakesASliceAndTheLastOneDropsTheDay) {
  shell_.Run(InsertSql(1, 2 * kRetainRowsMax + 1));
  for (std::size_t call = 1; call <= 2; ++call) {
    const Erased erased = Retain();
    EXPECT_EQ(erased.rejects_kept, kRetainRowsMax);
    EXPECT_TRUE(erased.more);
    EXPECT_EQ(Days(), "1\n");
    EXPECT_EQ(Rows("kept_rejects"), std::to_string(call * kRetainRowsMax) + "\n");
    EXPECT_EQ(Rows("quarantine"), std::to_string((2 - call) * kRetainRowsMax + 1) + "\n");
  }
  const Erased last = Retain();
  EXPECT_EQ(last.rejects_kept, 1U);
  EXPECT_FALSE(last.more);
  EXPECT_EQ(Days(), "0\n");
  EXPECT_EQ(Rows("kept_rejects"), std::to_string(2 * kRetainRowsMax + 1) + "\n");
}

// The row is written before the day is looked at, and committed after.
TEST_F(PostgresQuarantineDays, WhatIsBeingWrittenIsWaitedForAndKept) {
  shell_.Run(InsertSql(1, 3));
  PostgresShell writer = database_.Shell();
  writer.Run("BEGIN");
  writer.Run(InsertSql(4, 4, "00:30"));
  auto retained = std::async(std::launch::async, [this] { return Retain(); });
  EXPECT_TRUE(Eventually([this] {
    return shell_.Read(
               "SELECT count(*) FROM pg_locks AS l JOIN pg_database AS d"
               " ON d.oid = l.database WHERE NOT l.granted AND d.datname = '" +
               database_.name() + "'") == "1\n";
  }));
  writer.Run("COMMIT");
  EXPECT_EQ(retained.get().rejects_kept, 4U);
  EXPECT_EQ(Days(), "0\n");
  EXPECT_EQ(Rows("kept_rejects"), "4\n");
}

// It would have been lost with the day.
TEST_F(PostgresQuarantineDays, ADayThatHasRowsIsNotDropped) {
  shell_.Run(InsertSql(1, 1));
  PostgresShell server(database_.url());
  EXPECT_EQ(server.Read("SELECT uplinkd.drop_partitions('quarantine', '2025-11-22')"), "1\n")
      << "the day before is empty";
  EXPECT_EQ(Days(), "1\n");
  EXPECT_EQ(server.Read("SELECT day, taken, kept FROM uplinkd.take_quarantine('2025-11-22',"
                        " '-infinity', 10)"),
            "2025-11-21|1|1\n");
  EXPECT_EQ(server.Read("SELECT uplinkd.drop_partitions('quarantine', '2025-11-22')"), "1\n");
  EXPECT_EQ(Days(), "0\n");
  EXPECT_EQ(server.Read("SELECT day IS NULL FROM uplinkd.take_quarantine('2025-11-22',"
                        " '-infinity', 10)"),
            "t\n");
}

}  // namespace
}  // namespace uplink::storage::postgres
