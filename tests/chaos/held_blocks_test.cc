#include "tests/chaos/held_blocks.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "tests/chaos/script.h"

namespace uplink::chaos {
namespace {

/// A file in memory: what a kill leaves.
class HeldBlocksTest : public ::testing::Test {
 protected:
  HeldBlocks::ReadFile Reader() {
    return [this](std::span<char> bytes, std::int64_t offset) {
      std::ranges::fill(bytes, '\0');
      const auto from = static_cast<std::size_t>(offset);
      if (from < disk_.size()) {
        disk_.copy(bytes.data(), std::min(bytes.size(), disk_.size() - from), from);
      }
      return 0;
    };
  }
  HeldBlocks::WriteFile Writer() {
    return [this](std::span<const char> bytes, std::int64_t offset) {
      const auto from = static_cast<std::size_t>(offset);
      disk_.resize(std::max(disk_.size(), from + bytes.size()), '\0');
      std::ranges::copy(bytes, disk_.begin() + offset);
      return 0;
    };
  }
  void Write(const std::string& text, std::int64_t offset) {
    EXPECT_EQ(blocks_.Write(text, offset, Reader(), Writer()), 0);
  }
  std::string Seen() {
    std::string text(static_cast<std::size_t>(blocks_.size()), 'x');
    EXPECT_EQ(blocks_.Read(text, 0, Reader()), 0);
    return text;
  }

  std::string disk_;
  HeldBlocks blocks_{0, 1};
};

TEST_F(HeldBlocksTest, WhatIsNotSyncedIsSeenAndNotOnDisk) {
  std::string all;
  for (int i = 0; i < 100; ++i) {
    const std::string text(700, static_cast<char>('a' + i % 26));
    Write(text, static_cast<std::int64_t>(all.size()));
    all += text;
  }
  EXPECT_EQ(Seen(), all);
  EXPECT_NE(disk_, all);
  EXPECT_FALSE(disk_.empty()) << "some get through";
  EXPECT_EQ(blocks_.Flush(Writer()), 0);
  EXPECT_EQ(disk_, all);
  EXPECT_EQ(Seen(), all);
}

TEST_F(HeldBlocksTest, PartsOfBlocksKeepWhatWasThere) {
  Write(std::string(2000, 'a'), 0);
  EXPECT_EQ(blocks_.Flush(Writer()), 0);
  Write("bb", 511);
  std::string expected(2000, 'a');
  expected.replace(511, 2, "bb");
  EXPECT_EQ(Seen(), expected);
  EXPECT_EQ(blocks_.Flush(Writer()), 0);
  EXPECT_EQ(disk_, expected);
}

TEST_F(HeldBlocksTest, ATruncationDropsWhatWasHeldBehindIt) {
  Write(std::string(3000, 'a'), 0);
  blocks_.Truncate(1024);
  disk_.resize(std::min<std::size_t>(disk_.size(), 1024));
  EXPECT_EQ(Seen(), std::string(1024, 'a'));
  EXPECT_EQ(blocks_.Flush(Writer()), 0);
  EXPECT_EQ(disk_, std::string(1024, 'a'));
}

TEST(ChaosScriptTest, ANumberIsAlwaysTheSameMessage) {
  for (model::Seq seq = 1; seq <= 2 * kSteps; ++seq) {
    EXPECT_EQ(PayloadOf(seq), PayloadOf(seq));
    EXPECT_NE(PayloadOf(seq), PayloadOf(seq + 1));
  }
  EXPECT_EQ(SessionOf(1, 2), SessionOf(1, 2));
  EXPECT_NE(SessionOf(1, 2), SessionOf(1, 3));
  EXPECT_NE(SessionOf(1, 2), SessionOf(2, 2));
}

}  // namespace
}  // namespace uplink::chaos
