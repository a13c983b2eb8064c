#include "server/store/space_rounds.h"

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::store {
namespace {

using robot::HeldBack;
using std::chrono::minutes;
using std::chrono::seconds;
using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr seconds kLook{2};
constexpr std::uint64_t kMiB = 1 << 20;
constexpr std::uint64_t kMin = 100 * kMiB;
constexpr std::uint64_t kRate = 1000;

class SpaceRoundsTest : public ::testing::Test {
 protected:
  SpaceRoundsTest() {
    for (const char* ruri : {"rcan://a", "rcan://b", "rcan://c", "rcan://d", "rcan://greedy"}) {
      robots_.push_back(*fleet_.FindOrAdmit({ruri, "f"}));
    }
  }
  static void Store(robot::Robot& robot, std::uint64_t bytes, SteadyTime now) {
    robot.flow.Take(bytes, kNoFlowLimits, now);
  }
  /// Rounds for so long, in which all store what they are used to.
  void Pass(milliseconds span) {
    for (; span.count() > 0; span -= kLook) {
      clock_.Advance(kLook);
      for (const fleet::RobotPtr& robot : robots_) {
        const bool greedy = robot == robots_.back();
        Store(*robot, (greedy ? 100 : 1) * kRate * kLook.count(), clock_.Steady());
      }
      rounds_.Round();
    }
  }
  void SetFree(std::uint64_t free_bytes) {
    space_ = storage::DiskSpace{.free_bytes = free_bytes, .total_bytes = 10'000 * kMiB};
  }
  /// By what the robot's next record would be held back, long after its last.
  [[nodiscard]] HeldBack Held(const robot::Robot& robot, std::size_t bytes = 1) const {
    return robot.flow.LookAt(bytes, kNoFlowLimits, clock_.Steady()).by;
  }
  /// Of all robots, in their order.
  [[nodiscard]] std::vector<HeldBack> AllHeld() const {
    std::vector<HeldBack> held;
    for (const fleet::RobotPtr& robot : robots_) held.push_back(Held(*robot));
    return held;
  }

  static constexpr robot::FlowLimits kNoFlowLimits{.records = {}, .bytes = {}};
  testing::ManualClock clock_;
  fleet::Fleet fleet_{clock_, 100, {}};
  std::vector<fleet::RobotPtr> robots_;
  absl::StatusOr<std::optional<storage::DiskSpace>> space_ =
      storage::DiskSpace{.free_bytes = 5000 * kMiB, .total_bytes = 10'000 * kMiB};
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  SpaceRounds rounds_{{fleet_, clock_, logger_, [this] { return space_; }, kMin}};
};

TEST_F(SpaceRoundsTest, WithEnoughSpaceNobodyIsLimited) {
  SetFree(kMin);
  Pass(minutes(10));
  EXPECT_THAT(AllHeld(), ::testing::Each(HeldBack::kNone));
  EXPECT_EQ(rounds_.view().state, SpaceState::kEnough);
  EXPECT_EQ(rounds_.view().space, *space_);
  EXPECT_EQ(rounds_.view().free_min, kMin);
  EXPECT_THAT(lines_, IsEmpty());
}

TEST_F(SpaceRoundsTest, WhenItIsScarceTheGreedyOneIsSlowedDownToTheMedian) {
  Pass(minutes(10));
  SetFree(kMin - 1);
  Pass(kLook);
  EXPECT_EQ(rounds_.view().state, SpaceState::kScarce);
  EXPECT_EQ(rounds_.view().robots_limited, 1U);
  EXPECT_THAT(lines_, ElementsAre(AllOf(HasSubstr("warn"), HasSubstr("store_space_scarce"),
                                        HasSubstr("free_bytes=" + std::to_string(kMin - 1)),
                                        HasSubstr("free_min_bytes=" + std::to_string(kMin)),
                                        HasSubstr("robots_limited=1"),
                                        HasSubstr("heaviest=\"rcan://greedy"))));
  // At 1,000 bytes per second, 100 times as much needs a while.
  Pass(kLook);
  EXPECT_THAT(AllHeld(), ElementsAre(HeldBack::kNone, HeldBack::kNone, HeldBack::kNone,
                                     HeldBack::kNone, HeldBack::kDisk));
  clock_.Advance(minutes(10));
  EXPECT_EQ(Held(*robots_.back()), HeldBack::kNone) << "it is slowed down, not stopped";
  EXPECT_THAT(lines_, SizeIs(1)) << "told once";
}

TEST_F(SpaceRoundsTest, BelowHalfOfItNobodyStoresAnything) {
  Pass(minutes(10));
  SetFree(kMin / 2);
  Pass(kLook);
  EXPECT_EQ(rounds_.view().state, SpaceState::kScarce);
  SetFree(kMin / 2 - 1);
  Pass(kLook);
  EXPECT_EQ(rounds_.view().state, SpaceState::kStopped);
  clock_.Advance(std::chrono::hours(1));
  EXPECT_THAT(AllHeld(), ::testing::Each(HeldBack::kDisk));
  EXPECT_THAT(lines_.back(), AllOf(HasSubstr("error"), HasSubstr("store_space_stopped")));
}

TEST_F(SpaceRoundsTest, WithSpaceAgainAllGoOn) {
  Pass(minutes(10));
  SetFree(0);
  Pass(kLook);
  SetFree(kMin * 6 / 10);
  rounds_.Round();
  EXPECT_EQ(rounds_.view().state, SpaceState::kScarce);
  EXPECT_EQ(rounds_.view().robots_limited, 1U);
  Pass(kLook);
  EXPECT_THAT(AllHeld(), ElementsAre(HeldBack::kNone, HeldBack::kNone, HeldBack::kNone,
                                     HeldBack::kNone, HeldBack::kDisk));
  SetFree(kMin * 12 / 10);
  rounds_.Round();
  EXPECT_EQ(rounds_.view().state, SpaceState::kEnough);
  EXPECT_EQ(rounds_.view().robots_limited, 0U);
  EXPECT_THAT(AllHeld(), ::testing::Each(HeldBack::kNone));
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("store_space_stopped"), HasSubstr("store_space_scarce"),
                                  AllOf(HasSubstr("info"), HasSubstr("store_space_enough"),
                                        HasSubstr("robots_released=1"))));
}

TEST_F(SpaceRoundsTest, WhoComesMeanwhileIsJudgedToo) {
  Pass(minutes(10));
  SetFree(kMin / 2 - 1);
  Pass(kLook);
  const fleet::RobotPtr late = *fleet_.FindOrAdmit({"rcan://late", "f"});
  EXPECT_EQ(Held(*late), HeldBack::kNone);
  rounds_.Round();
  EXPECT_EQ(Held(*late), HeldBack::kDisk);
  SetFree(kMin / 2 + kMin / 4);
  rounds_.Round();
  EXPECT_EQ(Held(*late), HeldBack::kNone);
  Store(*late, 100 * kMiB, clock_.Steady());
  Pass(kWritersEvery);
  EXPECT_EQ(rounds_.view().robots_limited, 2U);
  EXPECT_EQ(Held(*late, kMiB), HeldBack::kNone) << "a full bucket passes anything";
  Store(*late, kMiB, clock_.Steady());
  EXPECT_EQ(Held(*late), HeldBack::kDisk);
  EXPECT_THAT(lines_.back(), AllOf(HasSubstr("store_space_limits"), HasSubstr("robots=1"),
                                   HasSubstr("rcan://late"), Not(HasSubstr("greedy"))));
}

TEST_F(SpaceRoundsTest, ALineNamesTheHeaviestFew) {
  for (const fleet::RobotPtr& robot : robots_) Store(*robot, kMiB, clock_.Steady());
  // More robots than heavy ones, so that the median is one of the others.
  for (std::size_t i = 0; i < 20; ++i) {
    const auto light = *fleet_.FindOrAdmit({"rcan://light" + std::to_string(i), "f"});
    Store(*light, 2 * kMiB, clock_.Steady());
  }
  for (std::size_t i = 0; i <= kHeaviestNamedMax; ++i) {
    const auto heavy = *fleet_.FindOrAdmit({"rcan://heavy" + std::to_string(i), "f"});
    Store(*heavy, (100 + i) * kMiB, clock_.Steady());
  }
  SetFree(kMin - 1);
  clock_.Advance(kWritersEvery);
  rounds_.Round();
  ASSERT_THAT(lines_, SizeIs(1));
  EXPECT_THAT(lines_.front(), AllOf(HasSubstr("robots_limited=6"), HasSubstr("rcan://heavy5"),
                                    HasSubstr("rcan://heavy1"), Not(HasSubstr("rcan://heavy0"))));
}

TEST_F(SpaceRoundsTest, RobotsThatStoreAboutTheSameAreNamedToo) {
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    Store(*robots_[i], (20 + i) * kMiB, clock_.Steady());
  }
  const auto idle = *fleet_.FindOrAdmit({"rcan://idle", "f"});
  SetFree(kMin - 1);
  clock_.Advance(kWritersEvery);
  rounds_.Round();
  SetFree(kMin / 2 - 1);
  clock_.Advance(kLook);
  rounds_.Round();
  const auto named = AllOf(HasSubstr("robots_limited=0 "), ContainsRegex("rcan://greedy.*rcan://a"),
                           Not(HasSubstr("rcan://idle")));
  EXPECT_THAT(lines_, ElementsAre(AllOf(HasSubstr("store_space_scarce"), named),
                                  AllOf(HasSubstr("store_space_stopped"), named)));
}

TEST_F(SpaceRoundsTest, WhatCannotBeKnownIsNotJudged) {
  space_ = std::optional<storage::DiskSpace>();
  Pass(minutes(10));
  EXPECT_EQ(rounds_.view().state, SpaceState::kEnough);
  EXPECT_EQ(rounds_.view().space, std::nullopt);
  EXPECT_THAT(AllHeld(), ::testing::Each(HeldBack::kNone));
  EXPECT_THAT(lines_, IsEmpty());
}

TEST_F(SpaceRoundsTest, WhileTheDiskCannotBeAskedTheLastJudgementHolds) {
  SetFree(0);
  Pass(kLook);
  space_ = absl::UnavailableError("away");
  Pass(minutes(1));
  EXPECT_EQ(rounds_.view().state, SpaceState::kStopped);
  EXPECT_THAT(AllHeld(), ::testing::Each(HeldBack::kDisk));
  // It came back elsewhere, where the disk cannot be looked at.
  space_ = std::optional<storage::DiskSpace>();
  rounds_.Round();
  EXPECT_THAT(AllHeld(), ::testing::Each(HeldBack::kNone));
}

TEST_F(SpaceRoundsTest, OneRoundIsUnderWayAtATime) {
  std::vector<std::function<void()>> jobs;
  bool takes_jobs = true;
  const auto post = [&](std::function<void()> job) {
    if (takes_jobs) jobs.push_back(std::move(job));
    return takes_jobs;
  };
  rounds_.LookOn(post);
  rounds_.LookOn(post);
  ASSERT_THAT(jobs, SizeIs(1));
  jobs.back()();
  EXPECT_NE(rounds_.view().space, std::nullopt);
  takes_jobs = false;
  rounds_.LookOn(post);
  takes_jobs = true;
  rounds_.LookOn(post);
  EXPECT_THAT(jobs, SizeIs(2)) << "one that was not taken is asked for again";
}

}  // namespace
}  // namespace uplink::store
