#include "server/store/access_rounds.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/store/saved_access.h"
#include "tests/support/eventually.h"
#include "tests/unit/server/store/access_rounds_fixture.h"

namespace uplink::store {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(AccessRoundsTest, TheStartReadsAll) {
  Revoke(1);
  Revoke(2);
  Revoke(2, false);
  Block("rcan://a/1");
  rounds().Begin(absl::OkStatus());
  EXPECT_TRUE(Denies(1));
  EXPECT_FALSE(Denies(2));
  EXPECT_TRUE(IsBlocked("rcan://a/1"));
  EXPECT_FALSE(rounds().unread());
  EXPECT_EQ(probe_.of_store.value(), 1);
}

TEST_F(AccessRoundsTest, AChangeIsReadOnceAndTold) {
  rounds().Begin(absl::OkStatus());
  const int before = changes_;
  Revoke(1);
  EXPECT_EQ(rounds().Round(), kLookAtAccessEvery);
  EXPECT_TRUE(Denies(1));
  EXPECT_EQ(changes_, before + 1);
  const int reads = store_.reads;
  rounds().Round();
  EXPECT_EQ(store_.reads, reads) << "the version alone is asked for";
  Revoke(1, false);
  rounds().Round();
  EXPECT_FALSE(Denies(1));
  EXPECT_EQ(changes_, before + 2);
}

TEST_F(AccessRoundsTest, ASettingAloneLooksAtNoConnection) {
  rounds().Begin(absl::OkStatus());
  const int before = changes_;
  Block("rcan://a/1");
  rounds().Round();
  EXPECT_TRUE(IsBlocked("rcan://a/1"));
  EXPECT_EQ(changes_, before);
}

TEST_F(AccessRoundsTest, MorePagesThanOneAreRead) {
  const int count = static_cast<int>(storage::kAccessPageMax) * 2 + 1;
  for (int i = 0; i < count; ++i) {
    store_.revocations.push_back(KeyRevocation(i));
    store_.revocations.back().version = ++store_.version;
  }
  rounds().Begin(absl::OkStatus());
  EXPECT_EQ(denied_.Get()->size(), static_cast<std::size_t>(count));
}

TEST_F(AccessRoundsTest, WhatWasReadCountsWhileTheStoreIsAway) {
  Revoke(1);
  rounds().Begin(absl::OkStatus());
  store_.status = kAway;
  EXPECT_EQ(rounds().Round(), kLookAtAccessAgainEvery);
  rounds().Round();
  EXPECT_TRUE(Denies(1));
  EXPECT_EQ(std::ranges::count_if(lines_,
                                  [](const std::string& line) {
                                    return line.find("access_fails") != std::string::npos;
                                  }),
            1);
  store_.status = absl::OkStatus();
  Revoke(2);
  rounds().Round();
  EXPECT_TRUE(Denies(2));
  EXPECT_THAT(lines_, Contains(HasSubstr("access_works_again")));
}

TEST_F(AccessRoundsTest, AWholeReadThatFindsNothingNewTellsNobody) {
  Revoke(1);
  Block("rcan://a/1");
  rounds().Begin(absl::OkStatus());
  const auto told = std::pair(changes_, lines_.size());
  const auto saved = std::filesystem::last_write_time(saved_path_);
  clock_.Advance(kWholeReadEvery);
  const int reads = store_.reads;
  rounds().Round();
  EXPECT_EQ(store_.reads, reads + 1);
  EXPECT_EQ(std::pair(changes_, lines_.size()), told);
  EXPECT_EQ(std::filesystem::last_write_time(saved_path_), saved);
  rounds().Round();
  EXPECT_EQ(store_.reads, reads + 1);
}

TEST_F(AccessRoundsTest, AWholeReadEndsStreamsAsOperatorsAskedSince) {
  rounds().Begin(absl::OkStatus());
  std::size_t asked = 0;
  settings_->OnChange([&asked](std::span<const fleet::RobotSettings::Change> changes) {
    asked += static_cast<std::size_t>(
        std::ranges::count_if(changes, [](const auto& each) { return each.disconnect; }));
  });
  store_.settings.push_back(
      {.ruri = "rcan://a/1", .disconnect_at = FromUnixMs(1), .version = ++store_.version});
  clock_.Advance(kWholeReadEvery);
  rounds().Round();
  EXPECT_EQ(asked, 1U);
  clock_.Advance(kWholeReadEvery);
  rounds().Round();
  EXPECT_EQ(asked, 1U);
}

TEST_F(AccessRoundsTest, TheFirstReadEndsNoStream) {
  store_.settings.push_back(
      {.ruri = "rcan://a/1", .disconnect_at = clock_.System(), .version = ++store_.version});
  static_cast<void>(rounds());
  std::size_t asked = 0;
  settings_->OnChange([&asked](std::span<const fleet::RobotSettings::Change> changes) {
    asked += static_cast<std::size_t>(
        std::ranges::count_if(changes, [](const auto& each) { return each.disconnect; }));
  });
  rounds().Begin(absl::OkStatus());
  clock_.Advance(kWholeReadEvery);
  rounds().Round();
  EXPECT_EQ(asked, 0U);
}

TEST_F(AccessRoundsTest, ALookThatFailsIsRepeatedAtOnceAndReadsAll) {
  Revoke(1);
  Revoke(2);
  rounds().Begin(absl::OkStatus());
  PutBack();
  store_.fails_once = true;
  EXPECT_EQ(rounds().Round(), kLookAtAccessEvery);
  ExpectAsPutBack();
  EXPECT_FALSE(rounds().unread());
  EXPECT_THAT(lines_, Not(Contains(HasSubstr("access_fails"))));
}

TEST_F(AccessRoundsTest, TheSavedCopyCountsWhileTheStoreIsAwayAtTheStart) {
  Revoke(1);
  rounds().Begin(absl::OkStatus());
  Block("rcan://a/1");
  rounds().Round();
  store_.status = kAway;
  Restart();
  rounds().Begin(kAway);
  EXPECT_TRUE(Denies(1));
  EXPECT_TRUE(IsBlocked("rcan://a/1"));
  EXPECT_TRUE(rounds().unread()) << "what others decide meanwhile is not known";
  EXPECT_THAT(lines_, Contains(HasSubstr("access_saved_list_used")));
  // The store has changed meanwhile.
  store_.status = absl::OkStatus();
  Revoke(1, false);
  Revoke(2);
  rounds().Round();
  EXPECT_FALSE(Denies(1));
  EXPECT_TRUE(Denies(2));
  EXPECT_FALSE(rounds().unread());
}

TEST_F(AccessRoundsTest, TheStartFallsBackIfTheStoreFailsWhileItIsRead) {
  Revoke(1);
  rounds().Begin(absl::OkStatus());
  store_.status = kAway;
  Restart();
  rounds().Begin(absl::OkStatus());
  EXPECT_TRUE(Denies(1));
}

TEST_F(AccessRoundsTest, WithoutACopyItSaysSoUntilTheStoreIsRead) {
  store_.status = kAway;
  rounds().Begin(kAway);
  EXPECT_TRUE(rounds().unread());
  EXPECT_THAT(lines_, Contains(HasSubstr("access_unread")));
  store_.status = absl::OkStatus();
  rounds().Round();
  EXPECT_FALSE(rounds().unread());
}

TEST_F(AccessRoundsTest, ACopyOfAnotherStoreIsNone) {
  ASSERT_TRUE(SaveAccess(saved_path_, TextOf({.revocations = {KeyRevocation(1)}, .settings = {}},
                                             "db:5432/other"))
                  .ok());
  store_.status = kAway;
  rounds().Begin(kAway);
  EXPECT_FALSE(Denies(1));
  EXPECT_TRUE(rounds().unread());
}

TEST_F(AccessRoundsTest, ACopyThatCannotBeSavedIsTriedAgain) {
  std::filesystem::remove_all(folder_);
  Revoke(1);
  rounds().Begin(absl::OkStatus());
  EXPECT_TRUE(Denies(1));
  EXPECT_THAT(lines_, Contains(HasSubstr("access_not_saved")));
  std::filesystem::create_directory(folder_);
  clock_.Advance(kLookAtAccessFilesEvery);
  rounds().Round();
  EXPECT_TRUE(std::filesystem::exists(saved_path_));
}

TEST_F(AccessRoundsTest, TheListsOfFilesCountBesideTheStore) {
  Revoke(1);
  lists_ = {{.serial = "0A"}};
  rounds().Begin(absl::OkStatus());
  EXPECT_TRUE(denied_.Get()->NamesSigned("0A", {}));
  EXPECT_TRUE(Denies(1));
  EXPECT_EQ(probe_.of_files.value(), 1);
  lists_ = {{.serial = "0B"}};
  rounds().Round();
  EXPECT_TRUE(denied_.Get()->NamesSigned("0A", {})) << "the next look is due later";
  clock_.Advance(kLookAtAccessFilesEvery);
  rounds().Round();
  EXPECT_FALSE(denied_.Get()->NamesSigned("0A", {}));
  EXPECT_TRUE(denied_.Get()->NamesSigned("0B", {}));
  EXPECT_TRUE(Denies(1));
}

TEST_F(AccessRoundsTest, AThreadFollowsTheStore) {
  rounds().Begin(absl::OkStatus());
  Revoke(1);
  rounds().Start();
  EXPECT_TRUE(testing::Eventually([this] { return Denies(1); }));
  rounds().Stop();
}

}  // namespace
}  // namespace uplink::store
