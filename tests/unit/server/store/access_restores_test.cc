// What a server notices of a store that was put back to an earlier state, and of its own saved
// copy.
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/store/access_rounds_fixture.h"

namespace uplink::store {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(AccessRoundsTest, AStoreThatWentBackIsReadAnew) {
  Revoke(1);
  Revoke(2);
  Block("rcan://a/1");
  rounds().Begin(absl::OkStatus());
  store_.revocations.resize(1);
  store_.settings.clear();
  store_.version = 1;
  rounds().Round();
  EXPECT_TRUE(Denies(1));
  EXPECT_FALSE(Denies(2));
  EXPECT_FALSE(IsBlocked("rcan://a/1"));
  EXPECT_THAT(lines_, Contains(HasSubstr("access_went_back")));
}

TEST_F(AccessRoundsTest, ARestoredStoreThatWasWrittenSinceIsReadAnew) {
  Revoke(1);
  Revoke(2);
  Block("rcan://a/1");
  rounds().Begin(absl::OkStatus());
  store_.status = kAway;
  rounds().Round();
  PutBack();
  store_.status = absl::OkStatus();
  rounds().Round();
  ExpectAsPutBack();
  EXPECT_THAT(lines_, Contains(HasSubstr("access_went_back")));
}

TEST_F(AccessRoundsTest, ARestoreThatNoLookNoticesCountsWithinAMinute) {
  Revoke(1);
  Revoke(2);
  Block("rcan://a/1");
  rounds().Begin(absl::OkStatus());
  PutBack();
  rounds().Round();
  EXPECT_TRUE(Denies(3));
  EXPECT_TRUE(Denies(2)) << "its version tells nothing of it";
  clock_.Advance(kWholeReadEvery);
  rounds().Round();
  ExpectAsPutBack();
}

TEST_F(AccessRoundsTest, ACopyThatIsNewerThanTheStoreIsKept) {
  Revoke(1);
  Revoke(2);
  rounds().Begin(absl::OkStatus());
  const auto text = ReadSavedAccess(saved_path_);
  store_.revocations.resize(1);
  store_.version = 1;
  Restart();
  rounds().Begin(absl::OkStatus());
  EXPECT_FALSE(Denies(2)) << "the store counts";
  EXPECT_THAT(lines_, Contains(AllOf(HasSubstr("access_saved_list_newer"), HasSubstr("version=1"),
                                     HasSubstr("saved_version=2"), HasSubstr(saved_path_))));
  EXPECT_EQ(ReadSavedAccess(saved_path_ + ".old").value(), *text);
  EXPECT_EQ(SavedVersion(saved_path_), 1U);
  // So it is where a server that runs sees its store go back.
  Revoke(3);
  rounds().Round();
  const auto later = ReadSavedAccess(saved_path_);
  store_.revocations.resize(1);
  store_.version = 1;
  rounds().Round();
  EXPECT_EQ(ReadSavedAccess(saved_path_ + ".old").value(), *later);
}

TEST_F(AccessRoundsTest, ANewerCopyThatCannotBeKeptIsNotReplaced) {
  Revoke(1);
  rounds().Begin(absl::OkStatus());
  std::filesystem::create_directories(saved_path_ + ".old");
  store_.revocations.clear();
  store_.version = 0;
  Restart();
  rounds().Begin(absl::OkStatus());
  EXPECT_THAT(lines_, Contains(HasSubstr("access_not_saved")));
  EXPECT_EQ(SavedVersion(saved_path_), 1U);
  std::filesystem::remove(saved_path_ + ".old");
  clock_.Advance(kLookAtAccessFilesEvery);
  rounds().Round();
  EXPECT_EQ(SavedVersion(saved_path_), 0U);
  EXPECT_EQ(SavedVersion(saved_path_ + ".old"), 1U);
}

TEST_F(AccessRoundsTest, ABlockThatARestoredStoreLacksIsWarnedOfAndKept) {
  Block("rcan://a/1");
  rounds().Begin(absl::OkStatus());
  const auto text = ReadSavedAccess(saved_path_);
  store_.status = kAway;
  rounds().Round();
  // Restored, and written since: no revocation is gone, and its version is later than any seen.
  store_.settings.clear();
  Block("rcan://a/2");
  store_.status = absl::OkStatus();
  rounds().Round();
  EXPECT_FALSE(IsBlocked("rcan://a/1")) << "the store counts";
  EXPECT_TRUE(IsBlocked("rcan://a/2"));
  EXPECT_THAT(lines_, Contains(AllOf(HasSubstr("access_went_back"), HasSubstr("lacks=1"))));
  EXPECT_EQ(ReadSavedAccess(saved_path_ + ".old").value(), *text);
  const std::size_t lines = lines_.size();
  clock_.Advance(kWholeReadEvery);
  rounds().Round();
  EXPECT_EQ(lines_.size(), lines) << "it is said once";
}

TEST_F(AccessRoundsTest, ABlockOfWhichTheRestoredStoreHasAnEarlierRowIsWarnedOf) {
  Block("rcan://a/1", false);
  const auto backup = std::pair(store_.settings, store_.version);
  Block("rcan://a/1");
  rounds().Begin(absl::OkStatus());
  store_.settings = backup.first;
  Revoke(1);
  rounds().Round();
  clock_.Advance(kWholeReadEvery);
  rounds().Round();
  EXPECT_FALSE(IsBlocked("rcan://a/1"));
  EXPECT_THAT(lines_, Contains(HasSubstr("access_went_back")));
}

TEST_F(AccessRoundsTest, WhatOperatorsTookBackIsNoLoss) {
  Revoke(1);
  Block("rcan://a/1");
  rounds().Begin(absl::OkStatus());
  store_.status = kAway;
  rounds().Round();
  Revoke(1, false);
  Block("rcan://a/1", false);
  store_.status = absl::OkStatus();
  rounds().Round();
  Restart();
  rounds().Begin(absl::OkStatus());
  EXPECT_THAT(lines_, Not(Contains(HasSubstr("access_went_back"))));
  EXPECT_THAT(lines_, Not(Contains(HasSubstr("access_saved_list_newer"))));
  EXPECT_FALSE(std::filesystem::exists(saved_path_ + ".old"));
}

TEST_F(AccessRoundsTest, ASavedCopyWhoseDecisionsTheStoreLacksAtTheStartIsKept) {
  Revoke(1);
  Revoke(2);
  Block("rcan://a/1");
  rounds().Begin(absl::OkStatus());
  const auto text = ReadSavedAccess(saved_path_);
  PutBack();
  store_.version = store_.revocations.back().version = 1'000;
  Restart();
  rounds().Begin(absl::OkStatus());
  ExpectAsPutBack();
  EXPECT_THAT(lines_, Contains(AllOf(HasSubstr("access_saved_list_newer"), HasSubstr("lacks=2"))));
  EXPECT_EQ(ReadSavedAccess(saved_path_ + ".old").value(), *text);
  EXPECT_EQ(SavedVersion(saved_path_), 1'000U);
}

TEST_F(AccessRoundsTest, ACopyThatWasRemovedOrChangedIsSavedAgain) {
  Block("rcan://a/1");
  rounds().Begin(absl::OkStatus());
  const auto text = ReadSavedAccess(saved_path_);
  const auto next_look = [this] {
    clock_.Advance(kLookAtAccessFilesEvery);
    rounds().Round();
  };
  std::filesystem::remove(saved_path_);
  next_look();
  EXPECT_EQ(ReadSavedAccess(saved_path_).value(), *text);
  std::ofstream(saved_path_) << "junk";
  // The store need not answer.
  store_.status = kAway;
  next_look();
  EXPECT_EQ(ReadSavedAccess(saved_path_).value(), *text);
  std::filesystem::permissions(saved_path_, std::filesystem::perms::all);
  next_look();
  EXPECT_EQ(ReadSavedAccess(saved_path_).value(), *text);
}

}  // namespace
}  // namespace uplink::store
