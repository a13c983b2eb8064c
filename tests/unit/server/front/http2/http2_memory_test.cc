#include "server/front/http2/http2_memory.h"

#include <cstring>
#include <vector>

#include <gtest/gtest.h>
#include <nghttp2/nghttp2.h>

namespace uplink::front {
namespace {

constexpr std::size_t kFrameBytes = 16'394;

class Http2MemoryTest : public ::testing::Test {
 protected:
  void* Allocate(std::size_t bytes) { return functions_.malloc(bytes, functions_.mem_user_data); }
  void Release(void* memory) { functions_.free(memory, functions_.mem_user_data); }

  Http2Memory memory_;
  nghttp2_mem functions_ = memory_.functions();
};

TEST_F(Http2MemoryTest, BlocksOfAllSizesHoldWhatIsWritten) {
  std::vector<std::pair<char*, std::size_t>> blocks;
  for (const std::size_t bytes :
       {1U, 32U, 8175U, 8176U, 8177U, 16'394U, 20'464U, 20'465U, 70'000U}) {
    for (int i = 0; i < 100; ++i) {
      auto* block = static_cast<char*>(Allocate(bytes));
      ASSERT_NE(block, nullptr);
      std::memset(block, static_cast<int>(blocks.size() % 251), bytes);
      blocks.emplace_back(block, bytes);
    }
  }
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const auto [block, bytes] = blocks[i];
    EXPECT_EQ(static_cast<unsigned char>(block[0]), i % 251);
    EXPECT_EQ(static_cast<unsigned char>(block[bytes - 1]), i % 251);
    Release(block);
  }
}

TEST_F(Http2MemoryTest, BlocksAreAlignedAsThoseOfTheCLibrary) {
  for (const std::size_t bytes : {1UL, kFrameBytes}) {
    void* block = Allocate(bytes);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block) % alignof(std::max_align_t), 0U);
    Release(block);
  }
}

TEST_F(Http2MemoryTest, ClearedMemoryIsClearAfterItWasUsed) {
  void* used = Allocate(kFrameBytes);
  std::memset(used, 0xFF, kFrameBytes);
  Release(used);
  auto* clear =
      static_cast<unsigned char*>(functions_.calloc(1, kFrameBytes, functions_.mem_user_data));
  for (std::size_t i = 0; i < kFrameBytes; ++i) ASSERT_EQ(clear[i], 0U) << i;
  Release(clear);
}

TEST_F(Http2MemoryTest, WhatGrowsKeepsItsContent) {
  auto* block = static_cast<char*>(Allocate(100));
  std::memset(block, 'x', 100);
  for (const std::size_t bytes : {9'000U, 30'000U, 50U}) {
    block = static_cast<char*>(functions_.realloc(block, bytes, functions_.mem_user_data));
    for (std::size_t i = 0; i < 50; ++i) ASSERT_EQ(block[i], 'x');
  }
  Release(block);
  Release(functions_.realloc(nullptr, 10, functions_.mem_user_data));
  Release(nullptr);
}

}  // namespace
}  // namespace uplink::front
