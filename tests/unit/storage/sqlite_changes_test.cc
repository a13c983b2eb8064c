// What an older file holds is shared from its migration on, and every later change of it is noted.
#include <algorithm>
#include <memory>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/sqlite/database.h"
#include "storage/sqlite/migrations.h"
#include "storage/sqlite/schema.h"
#include "storage/sqlite/shared_items.h"
#include "tests/support/temp_folder.h"

namespace uplink::storage::sqlite {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

constexpr std::string_view kOlderRows =
    "INSERT INTO shapes VALUES"
    " ('rcan://a', 'shared', 'north', 1, 1, 1, 0, 'n', 1, 'h', 1, 1, 0, 0, 0, '{}'),"
    " ('rcan://a', 'own', 'north', 1, 2, 1, 0, 'n', 1, 'h', 1, 0, 0, 0, 0, '{}');"
    "INSERT INTO objects VALUES"
    " ('rcan://a', 'shared', 'north', 1, 1, 1, 0, 'n', 0, 0, 2, 0.5, '{}', NULL)";

ItemKey Shape(std::string_view id) { return {PresentKind::kShape, "rcan://a", std::string(id)}; }
ItemKey Object(std::string_view id) { return {PresentKind::kObject, "rcan://a", std::string(id)}; }

TEST(SqliteChanges, WhatAnOlderFileSharesIsReadAndFollowed) {
  const testing::TempFolder folder;
  const std::string path = folder.File("uplinkd.db");
  const auto step = std::ranges::find_if(Migrations(), [](const Migration& migration) {
    return std::string_view(migration.name).ends_with("_changes");
  });
  ASSERT_NE(step, Migrations().end());
  auto database = Database::Open(path, Access::kWrite, milliseconds(100));
  ASSERT_TRUE(database.ok()) << database.status();
  const auto before = static_cast<std::size_t>(step - Migrations().begin());
  ASSERT_TRUE(Migrate(**database, Migrations().first(before), IfOlder::kMigrate).ok());
  const absl::Status written = (*database)->Execute(std::string(kOlderRows));
  ASSERT_TRUE(written.ok()) << written;
  ASSERT_TRUE(Migrate(**database, Migrations(), IfOlder::kMigrate).ok());

  auto items = SqliteSharedItems::Open(path);
  ASSERT_TRUE(items.ok()) << items.status();
  const auto positions = (*items)->Positions();
  ASSERT_TRUE(positions.ok()) << positions.status();
  const auto page = (*items)->Page({});
  ASSERT_TRUE(page.ok()) << page.status();
  std::vector<ItemKey> keys;
  for (const SharedItem& item : page->items) keys.push_back(item.Key());
  EXPECT_THAT(keys, ElementsAre(Shape("shared"), Object("shared")));
  EXPECT_THAT((*items)->ChangesSince(*positions)->keys, IsEmpty());

  ASSERT_TRUE((*database)
                  ->Execute("UPDATE shapes SET scope = 1 WHERE id = 'own';"
                            "DELETE FROM objects; UPDATE shapes SET scope = 0 WHERE id = 'shared'")
                  .ok());
  const auto changes = (*items)->ChangesSince(*positions);
  ASSERT_TRUE(changes.ok()) << changes.status();
  EXPECT_THAT(changes->keys, ElementsAre(Shape("own"), Object("shared"), Shape("shared")));
}

TEST(SqliteChanges, ARowOfAnotherKeyHasEndedUnderTheOldOne) {
  const testing::TempFolder folder;
  const std::string path = folder.File("uplinkd.db");
  auto database = Database::Open(path, Access::kWrite, milliseconds(100));
  ASSERT_TRUE(database.ok()) << database.status();
  ASSERT_TRUE(Migrate(**database, Migrations(), IfOlder::kMigrate).ok());
  ASSERT_TRUE((*database)->Execute(std::string(kOlderRows)).ok());
  auto items = SqliteSharedItems::Open(path);
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
