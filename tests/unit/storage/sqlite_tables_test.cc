#include <gtest/gtest.h>

#include "storage/sqlite/table_writers.h"

namespace uplink::storage::sqlite {
namespace {

TEST(SqliteInsertSql, NamesEachColumnInTheOrderOfItsParameters) {
  EXPECT_EQ(InsertSql(kPresenceChangesTable).view(),
            "INSERT INTO presence_changes AS t (ruri, changed_at, entry, fleet, presence, why)"
            " VALUES (?, ?, ?, ?, ?, ?)");
}

TEST(SqliteInsertSql, ReplacesTheValuesOfARowThatIsThereAndKeepsTheRest) {
  EXPECT_EQ(InsertSql(kLatestPresenceTable).view(),
            "INSERT INTO presence_latest AS t (ruri, presence, changed_at, parked_until)"
            " VALUES (?, ?, ?, ?)"
            " ON CONFLICT (ruri) DO UPDATE SET presence = excluded.presence,"
            " changed_at = excluded.changed_at, parked_until = excluded.parked_until");
}

}  // namespace
}  // namespace uplink::storage::sqlite
