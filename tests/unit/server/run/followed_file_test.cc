#include "server/run/followed_file.h"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"

namespace uplink::run {
namespace {

class FollowedFileTest : public ::testing::Test {
 protected:
  FollowedFileTest() { Write("a"); }
  void Write(const std::string& text) const { std::ofstream(path_) << text; }

  const testing::TempFolder folder_;
  const std::string path_ = folder_.path() + "/uplinkd.toml";
};

TEST_F(FollowedFileTest, TellsAChangeOnceItHasStayed) {
  FollowedFile file(path_);
  EXPECT_FALSE(file.Look());
  Write("ab");
  EXPECT_FALSE(file.Look()) << "it may be half written";
  Write("abc");
  EXPECT_FALSE(file.Look());
  EXPECT_TRUE(file.Look());
  EXPECT_FALSE(file.Look());
}

TEST_F(FollowedFileTest, TellsAReplacementOfTheSameSize) {
  FollowedFile file(path_);
  std::ofstream(path_ + ".new") << "b";
  std::filesystem::rename(path_ + ".new", path_);
  EXPECT_FALSE(file.Look());
  EXPECT_TRUE(file.Look());
}

TEST_F(FollowedFileTest, AFileThatIsAwayHasNotChanged) {
  FollowedFile file(path_);
  std::filesystem::remove(path_);
  EXPECT_FALSE(file.Look());
  EXPECT_FALSE(file.Look());
  Write("abcd");
  EXPECT_FALSE(file.Look());
  EXPECT_TRUE(file.Look());
}

TEST_F(FollowedFileTest, WhatWasReadIsKnown) {
  FollowedFile file(path_);
  Write("abc");
  file.NoteRead();
  EXPECT_FALSE(file.Look());
  EXPECT_FALSE(file.Look());
}

}  // namespace
}  // namespace uplink::run
