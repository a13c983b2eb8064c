#include "server/view/brief_look.h"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace uplink::view {
namespace {

/// A thread that is stuck: what is posted to it runs when the test says so.
class BriefLookTest : public ::testing::Test {
 protected:
  BriefLook::Post Post() {
    return [this](std::function<void()> job) {
      if (!takes_) return false;
      jobs_.push_back(std::move(job));
      return true;
    };
  }
  void RunJobs() {
    for (const auto& job : std::exchange(jobs_, {})) job();
  }

  bool takes_ = true;
  std::vector<std::function<void()>> jobs_;
  int looks_ = 0;
};

TEST_F(BriefLookTest, WithoutAThreadItLooksAtOnce) {
  BriefLook look({});
  EXPECT_TRUE(look.Run([this] { ++looks_; }));
  EXPECT_EQ(looks_, 1);
}

TEST_F(BriefLookTest, OneThatEndsInTimeIsWaitedFor) {
  BriefLook look([](const std::function<void()>& job) {
    job();
    return true;
  });
  EXPECT_TRUE(look.Run([this] { ++looks_; }));
  EXPECT_TRUE(look.Run([this] { ++looks_; }));
  EXPECT_EQ(looks_, 2);
}

TEST_F(BriefLookTest, WhileOneTakesTooLongNobodyWaitsForAnother) {
  BriefLook look(Post(), milliseconds(1));
  EXPECT_FALSE(look.Run([this] { ++looks_; }));
  EXPECT_FALSE(look.Run([this] { ++looks_; }));
  EXPECT_EQ(jobs_.size(), 1U) << "the second is not even begun";
  RunJobs();
  EXPECT_EQ(looks_, 1) << "it ends, late";
  EXPECT_FALSE(look.Run([this] { ++looks_; }));
  EXPECT_EQ(jobs_.size(), 1U) << "the next one is tried again";
}

TEST_F(BriefLookTest, OneThatIsDroppedIsOver) {
  BriefLook look(Post(), milliseconds(1));
  EXPECT_FALSE(look.Run([] {}));
  jobs_.clear();
  EXPECT_FALSE(look.Run([] {}));
  EXPECT_EQ(jobs_.size(), 1U);
}

TEST_F(BriefLookTest, AThreadThatTakesNoJobIsNotWaitedFor) {
  takes_ = false;
  BriefLook look(Post(), std::chrono::hours(1));
  EXPECT_FALSE(look.Run([] {}));
  EXPECT_FALSE(look.Run([] {}));
}

TEST_F(BriefLookTest, ALateLookMayOutliveIt) {
  {
    BriefLook look(Post(), milliseconds(1));
    EXPECT_FALSE(look.Run([this] { ++looks_; }));
  }
  RunJobs();
  EXPECT_EQ(looks_, 1);
}

}  // namespace
}  // namespace uplink::view
