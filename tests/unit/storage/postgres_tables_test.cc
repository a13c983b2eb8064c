#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "storage/postgres/tables/insert.h"
#include "storage/postgres/tables/present_sql.h"
#include "storage/tables/connections.h"
#include "storage/tables/latest.h"
#include "storage/tables/set_aside.h"

namespace uplink::storage::postgres {
namespace {

TEST(InsertSql, NamesEachColumnInTheOrderOfItsParameters) {
  EXPECT_EQ(
      InsertSql(kPresenceChangesTable).view(),
      "INSERT INTO uplinkd.presence_changes AS t (ruri, changed_at, entry, fleet, presence,"
      " why) SELECT ruri, changed_at, (SELECT currval('uplinkd.batches') << 20) + entry, fleet,"
      " presence, why"
      " FROM unnest($1::text[], $2::timestamptz[], $3::int[], $4::text[], $5::int[],"
      " $6::int[]) AS u (ruri, changed_at, entry, fleet, presence, why)");
}

TEST(InsertSql, ReplacesTheValuesOfARowThatIsThereAndKeepsTheRest) {
  EXPECT_TRUE(
      InsertSql(kGapsTable)
          .view()
          .ends_with(" ON CONFLICT (ruri, session, first) DO UPDATE SET last ="
                     " CASE WHEN t.last < excluded.last THEN excluded.last ELSE t.last END"));
}

TEST(InsertSql, UpdatesOnlyTheRowsThatTheTableNames) {
  const SqlText sql = InsertSql(kConnectionsTable, "WITH known AS (SELECT 1) ", " WHERE known");
  EXPECT_TRUE(sql.view().starts_with("WITH known AS (SELECT 1) INSERT INTO uplinkd.connections"));
  EXPECT_NE(sql.view().find(" WHERE known ON CONFLICT (ruri, id) DO UPDATE SET agent_version ="),
            std::string_view::npos);
  EXPECT_TRUE(sql.view().ends_with(" WHERE " + std::string(kReplacedConnections.view())));
}

TEST(InsertSql, CountsPastNineParameters) {
  EXPECT_NE(InsertSql(kQuarantineTable).view().find("$9::text[], $10::bigint[], $11::bytea[]"),
            std::string_view::npos);
}

TEST(AddInsert, FillsEveryColumnOnceForEachRow) {
  PresenceItem online;
  online.robot = std::make_shared<const model::RobotId>();
  online.presence = model::Presence::kOnline;
  PresenceItem offline = online;
  offline.presence = model::Presence::kOffline;
  std::vector<StoreCall> calls;
  AddInsert<kPresenceChangesTable>(std::vector<PresenceChange>{{&online, 1}, {&offline, 2}}, calls);
  ASSERT_EQ(calls.size(), 1U);
  EXPECT_EQ(calls[0].sql, InsertSql(kPresenceChangesTable).view());
  ASSERT_EQ(calls[0].parameters.values().size(), 6U);
  Array presences(Type::kInt4);
  presences.Int4(static_cast<std::int32_t>(model::Presence::kOnline));
  presences.Int4(static_cast<std::int32_t>(model::Presence::kOffline));
  EXPECT_EQ(calls[0].parameters.values()[4], std::move(presences).Take());
}

TEST(AddInsert, AddsNothingWithoutRows) {
  std::vector<StoreCall> calls;
  AddInsert<kGapsTable>(std::vector<Gap>{}, calls);
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
