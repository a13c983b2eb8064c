#include "server/front/call/unfinished.h"

#include <vector>

#include <gtest/gtest.h>

namespace uplink::front {
namespace {

constexpr std::size_t kBytesMax = 100;
constexpr std::size_t kShareMax = 60;
constexpr std::size_t kMiB = std::size_t{1024} * 1024;

SteadyTime At(int ms) { return SteadyTime{} + milliseconds(ms); }

using Calls = std::vector<std::uint64_t>;

/// The calls of one thread.
class Wakes final : public loop::WakeInbox {
 public:
  void Wake(std::uint64_t call) override { calls_.push_back(call); }
  [[nodiscard]] const Calls& calls() const { return calls_; }

 private:
  Calls calls_;
};

class UnfinishedTest : public ::testing::Test {
 protected:
  /// A message of a call of the first thread, each of a key of its own.
  void Set(std::uint64_t call, std::uint64_t message, std::size_t bytes, SteadyTime now) {
    SetOf(static_cast<std::uint8_t>(call), call, message, bytes, now);
  }
  void SetOf(std::uint8_t key, std::uint64_t call, std::uint64_t message, std::size_t bytes,
             SteadyTime now) {
    unfinished_.Set({&wakes_, call}, {key}, message, bytes, now);
  }
  [[nodiscard]] bool MustEnd(std::uint64_t call) { return unfinished_.MustEnd({&wakes_, call}); }
  [[nodiscard]] std::int64_t bytes() const { return probe_.unfinished_bytes.value(); }

  transport::RelayProbe probe_;
  Unfinished unfinished_{{.bytes_max = kBytesMax, .share_max = kShareMax}, probe_};
  Wakes wakes_;
  Wakes other_wakes_;
};

TEST_F(UnfinishedTest, NobodyEndsAtTheLimit) {
  Set(1, 0, 40, At(1));
  Set(2, 0, 60, At(2));
  EXPECT_EQ(bytes(), static_cast<std::int64_t>(kBytesMax));
  EXPECT_FALSE(MustEnd(1));
  EXPECT_EQ(wakes_.calls(), Calls());
}

TEST_F(UnfinishedTest, PastItTheOneThatBeganFirstEnds) {
  Set(2, 0, 1, At(1));
  Set(1, 0, 50, At(2));
  Set(3, 0, 50, At(3));
  EXPECT_EQ(wakes_.calls(), Calls{2});
  EXPECT_TRUE(MustEnd(2)) << "how much it holds is no measure of how slow it is";
  EXPECT_FALSE(MustEnd(1));
  Set(2, 0, 0, At(4));
  EXPECT_FALSE(MustEnd(1)) << "it is enough";
}

TEST_F(UnfinishedTest, TheNextEndsIfThatWasNotEnough) {
  Set(1, 0, 10, At(1));
  Set(2, 0, 60, At(2));
  Set(3, 0, 60, At(3));
  EXPECT_EQ(wakes_.calls(), Calls{1});
  Set(3, 0, 59, At(4));
  EXPECT_EQ(wakes_.calls(), Calls{1}) << "one at a time";
  Set(1, 0, 0, At(5));
  EXPECT_EQ(wakes_.calls(), (Calls{1, 2}));
}

TEST_F(UnfinishedTest, AMessageKeepsTheTimeOfItsBeginning) {
  Set(1, 0, 10, At(1));
  Set(2, 0, 45, At(2));
  Set(1, 0, 56, At(9));
  EXPECT_TRUE(MustEnd(1));
}

TEST_F(UnfinishedTest, AnotherMessageOfTheCallBeginsAnew) {
  Set(1, 0, 10, At(1));
  Set(2, 0, 50, At(2));
  Set(1, 0, 0, At(3));
  Set(1, 0, 55, At(4));
  EXPECT_TRUE(MustEnd(2));
}

// A busy stream always has one that is unfinished, each time another.
TEST_F(UnfinishedTest, TheNextMessageOfTheCallBeginsAnewThoughNoMomentWasWithoutOne) {
  Set(1, 0, 10, At(1));
  Set(2, 0, 50, At(2));
  Set(1, 1, 55, At(3));
  EXPECT_TRUE(MustEnd(2));
  Set(1, 1, 0, At(4));
  EXPECT_EQ(bytes(), 50);
}

TEST_F(UnfinishedTest, CallsWithoutAnyAreNotKept) {
  Set(1, 0, 0, At(1));
  EXPECT_EQ(bytes(), 0);
}

TEST_F(UnfinishedTest, ThreadsShareTheMemoryAndTheSlowestOfAllEnds) {
  Set(1, 0, 41, At(1));
  unfinished_.Set({&other_wakes_, 1}, {7}, 0, 60, At(2));
  EXPECT_EQ(bytes(), 101);
  EXPECT_EQ(wakes_.calls(), Calls{1});
  EXPECT_EQ(other_wakes_.calls(), Calls());
  EXPECT_FALSE(unfinished_.MustEnd({&other_wakes_, 1}));
}

TEST_F(UnfinishedTest, AKeyOverItsShareCostsItselfAlone) {
  constexpr std::uint8_t kGreedy = 9;
  Set(1, 0, 30, At(1));
  SetOf(kGreedy, 11, 0, 31, At(2));
  SetOf(kGreedy, 12, 0, 30, At(3));
  SetOf(kGreedy, 13, 0, 10, At(4));
  EXPECT_EQ(wakes_.calls(), Calls{11}) << "its slowest, though another key's began before";
  SetOf(kGreedy, 11, 0, 0, At(5));
  Set(2, 0, 31, At(6));
  EXPECT_EQ(wakes_.calls(), (Calls{11, 1})) << "no key is over a share now";
}

TEST(UnfinishedLimits, AreAPartOfTheMemoryUpToABound) {
  EXPECT_EQ(UnfinishedLimitsFor(0, kMiB).bytes_max, kUnfinishedBytesMax);
  EXPECT_EQ(UnfinishedLimitsFor(64 * kMiB, kMiB).bytes_max, 16 * kMiB);
  EXPECT_EQ(UnfinishedLimitsFor(4096 * kMiB, kMiB).bytes_max, kUnfinishedBytesMax);
}

TEST(UnfinishedLimits, AreAlwaysEnoughForOneMessage) {
  // Its five bytes before it, and memory that doubles as it grows.
  EXPECT_EQ(UnfinishedLimitsFor(64 * kMiB, 64 * kMiB).bytes_max, 2 * (64 * kMiB + 5));
  EXPECT_EQ(UnfinishedLimitsFor(1, kMiB).bytes_max, 2 * (kMiB + 5));
  EXPECT_EQ(UnfinishedLimitsFor(0, kMiB).share_max, 2 * (kMiB + 5));
}

}  // namespace
}  // namespace uplink::front
