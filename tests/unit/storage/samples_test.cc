#include "storage/samples.h"

#include <array>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::storage {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;

TEST(Samples, AreKnownAmongTheLastByTheirTimes) {
  SampleMemory memory;
  SampleMark mark{.timed = true};
  EXPECT_FALSE(IsDuplicate(mark, memory));
  for (std::uint8_t content = 0; content <= kSamplesKept; ++content) {
    mark.digest = {content};
    Remember(mark, memory);
  }
  EXPECT_THAT(memory.digests, SizeIs(kSamplesKept));
  mark.digest = {1};
  EXPECT_TRUE(IsDuplicate(mark, memory));
  mark.digest = {0};
  EXPECT_FALSE(IsDuplicate(mark, memory)) << "it went";
}

TEST(Samples, AreKnownAsTheLastWithoutTimes) {
  SampleMemory memory;
  SampleMark mark;
  for (const std::uint8_t content : std::array<std::uint8_t, 2>{1, 2}) {
    mark.digest = {content};
    mark.last = std::to_string(content);
    Remember(mark, memory);
  }
  EXPECT_TRUE(IsDuplicate(mark, memory));
  EXPECT_EQ(memory.last, "2");
  mark.digest = {1};
  EXPECT_FALSE(IsDuplicate(mark, memory));
}

TEST(Samples, LieInAColumnOneAfterTheOther) {
  const SampleDigest first{0, 0xFF, 1};
  const SampleDigest second{2};
  const std::string packed = PackedDigests({first, second});
  EXPECT_THAT(packed, SizeIs(32));
  const auto digests = DigestsIn(packed);
  ASSERT_TRUE(digests.has_value());
  EXPECT_THAT(*digests, ElementsAre(first, second));
  EXPECT_TRUE(DigestsIn("").has_value());
  EXPECT_FALSE(DigestsIn("short").has_value());
  EXPECT_TRUE(DigestsIn(std::string(16 * kSamplesKept, 'x')).has_value());
  EXPECT_FALSE(DigestsIn(std::string(16 * (kSamplesKept + 1), 'x')).has_value());
}

}  // namespace
}  // namespace uplink::storage
