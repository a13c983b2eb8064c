// What an operator does to the rows of items is noted.
#include <memory>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/sqlite/database.h"
#include "storage/sqlite/migrations.h"
#include "storage/sqlite/parts.h"
#include "storage/sqlite/schema.h"
#include "tests/support/temp_folder.h"

namespace uplink::storage::sqlite {
namespace {

using ::testing::UnorderedElementsAre;

constexpr std::string_view kRows =
    "INSERT INTO shapes VALUES"
    " ('rcan://a', 'shared', 'north', 1, 1, 1, 0, 'n', 1, 'h', 1, 1, 0, 0, 0, '{}'),"
    " ('rcan://a', 'own', 'north', 1, 2, 1, 0, 'n', 1, 'h', 1, 0, 0, 0, 0, '{}');"
    "INSERT INTO objects VALUES"
    " ('rcan://a', 'shared', 'north', 1, 1, 1, 0, 'n', 0, 0, 2, 0.5, '{}', NULL)";

ItemKey Shape(std::string_view id) { return {PresentKind::kShape, "rcan://a", std::string(id)}; }
ItemKey Object(std::string_view id) { return {PresentKind::kObject, "rcan://a", std::string(id)}; }

TEST(SqliteChanges, ARowOfAnotherKeyHasEndedUnderTheOldOne) {
  const testing::TempFolder folder;
  const std::string path = folder.File("uplinkd.db");
  auto database = Database::Open(path, Access::kWrite, milliseconds(100));
  ASSERT_TRUE(database.ok()) << database.status();
  ASSERT_TRUE(Migrate(**database, Migrations(), IfOlder::kMigrate).ok());
  ASSERT_TRUE((*database)->Execute(std::string(kRows)).ok());
  auto items = OpenSharedItems(path);
  ASSERT_TRUE(items.ok()) << items.status();
  const auto positions = (*items)->Positions();
  ASSERT_TRUE(positions.ok()) << positions.status();
  ASSERT_TRUE((*database)
                  ->Execute("UPDATE shapes SET id = 'new' WHERE id = 'shared';"
                            "UPDATE objects SET ruri = 'rcan://b'")
                  .ok());
  const auto changes = (*items)->ChangesSince(*positions);
  ASSERT_TRUE(changes.ok()) << changes.status();
  const ItemKey moved = {PresentKind::kObject, "rcan://b", "shared"};
  EXPECT_THAT(changes->keys,
              UnorderedElementsAre(Shape("shared"), Shape("new"), Object("shared"), moved));
}

}  // namespace
}  // namespace uplink::storage::sqlite
