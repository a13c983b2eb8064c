// Robots that make the others receive too much: what of theirs waits, and what does not.
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/forward/rounds.h"
#include "tests/unit/server/forward/rounds_bench.h"

namespace uplink::forward {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// A robot that goes over the pace with its second change, and one that receives.
class PacedRoundsTest : public RoundsTest {
 protected:
  PacedRoundsTest() {
    Round();
    static_cast<void>(Taken());
  }
  void PacedRound() { static_cast<void>(paced_.Round()); }
  std::size_t Taken() {
    std::vector<EncodedFrame> frames;
    receiver_->Take(frames);
    return frames.size();
  }

  static constexpr Paces::Limits kPaces = {.fan_out = {.rate = 1, .burst = 600}, .waiting_max = 10};
  Woken woken_;
  std::unique_ptr<session::ForwardReceiver> receiver_ =
      forwards_.Join({.ruri = "receiver", .fleet = "north"}, {&woken_, 7});
  Rounds paced_{{clock_, logger_, items_, forwards_, probe_, trust_, kPaces}};
};

std::string PointAt(int x) {
  return R"({"type":"Point","coordinates":[)" + std::to_string(x) + ".0,2.0]}";
}

TEST_F(PacedRoundsTest, OfWhatIsOverThePaceTheLatestComesLater) {
  PacedRound();
  items_.Set(KeyOf("a", "1"));
  PacedRound();
  EXPECT_EQ(Taken(), 1U);
  std::size_t told = 0;
  for (int x = 0; x < 5; ++x) {
    items_.Set(KeyOf("a", "1"), 0, PointAt(x));
    PacedRound();
    told += Taken();
  }
  items_.Set(KeyOf("b", "1"));
  PacedRound();
  EXPECT_EQ(Taken(), 1U) << "of another robot";
  EXPECT_EQ(told, 1U) << "the bucket had room for one more";
  EXPECT_EQ(probe_.paced_now.value(), 1);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("forward_paced robot=a")));
  clock_.Advance(std::chrono::hours(1));
  PacedRound();
  EXPECT_EQ(Taken(), 1U);
  EXPECT_EQ(probe_.paced_now.value(), 0);
  // What it is told now is what the store holds.
  items_.Set(KeyOf("a", "1"), 0, PointAt(4));
  PacedRound();
  EXPECT_EQ(Taken(), 0U);
}

TEST_F(PacedRoundsTest, AnEndWaitsForNoPace) {
  PacedRound();
  items_.Set(KeyOf("a", "1"));
  PacedRound();
  for (int x = 0; x < 5; ++x) {
    items_.Set(KeyOf("a", std::to_string(x)), 0, PointAt(x));
    PacedRound();
  }
  ASSERT_GT(probe_.paced_now.value(), 0);
  while (Taken() > 0) {
  }
  items_.Erase(KeyOf("a", "1"));
  for (int x = 0; x < 5; ++x) items_.Erase(KeyOf("a", std::to_string(x)));
  PacedRound();
  EXPECT_GT(Taken(), 0U);
  EXPECT_THAT(Ids(), IsEmpty());
  EXPECT_EQ(probe_.paced_now.value(), 0);
}

TEST_F(PacedRoundsTest, ARobotThatIsOverItsPaceLeavesItsFleetAtOnce) {
  PacedRound();
  items_.Set(KeyOf("a", "1"));
  PacedRound();
  for (int x = 0; x < 5; ++x) {
    static_cast<void>(Taken());
    items_.Set(KeyOf("a", "1"), 0, PointAt(x));
    PacedRound();
  }
  ASSERT_EQ(probe_.paced_now.value(), 1);
  while (Taken() > 0) {
  }
  items_.MoveToFleet(KeyOf("a", "1"), "south");
  PacedRound();
  EXPECT_EQ(Taken(), 1U) << "its end, to those that it left";
  EXPECT_THAT(Ids(), IsEmpty()) << "it comes to the others later";
  clock_.Advance(std::chrono::hours(1));
  PacedRound();
  EXPECT_THAT(Ids(), ElementsAre("1"));
  EXPECT_EQ(Taken(), 0U);
}

TEST_F(PacedRoundsTest, WhatWaitsForItsPaceLivesAsLongAsTheStoreSays) {
  const std::int64_t now = UnixMs(clock_.System());
  PacedRound();
  for (int x = 0; x < 5; ++x) {
    items_.Set(KeyOf("a", "1"), now + 3000, PointAt(x));
    PacedRound();
    static_cast<void>(Taken());
  }
  ASSERT_EQ(probe_.paced_now.value(), 1);
  clock_.Advance(milliseconds(2000));
  items_.Set(KeyOf("a", "1"), now + 6000, PointAt(5));
  PacedRound();
  ASSERT_EQ(probe_.paced_now.value(), 1);
  clock_.Advance(milliseconds(2000));
  PacedRound();
  EXPECT_EQ(Taken(), 0U) << "it is there";
  EXPECT_THAT(Ids(), ElementsAre("1"));
  clock_.Advance(milliseconds(2000));
  PacedRound();
  EXPECT_EQ(Taken(), 1U) << "its end";
  EXPECT_THAT(Ids(), IsEmpty());
}

TEST_F(PacedRoundsTest, AReadOfAllWaitsForNoPace) {
  PacedRound();
  for (int x = 0; x < 5; ++x) {
    items_.Set(KeyOf("a", std::to_string(x)));
    PacedRound();
  }
  ASSERT_GT(probe_.paced_now.value(), 0);
  items_.trimmed_to = items_.log.size() + 1;
  items_.Set(KeyOf("b", "1"));
  PacedRound();
  EXPECT_THAT(Ids(), SizeIs(6));
  EXPECT_EQ(probe_.paced_now.value(), 0);
}

}  // namespace
}  // namespace uplink::forward
