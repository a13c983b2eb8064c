#include "server/loop/one_at_a_time.h"

#include <functional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace uplink::loop {
namespace {

class OneAtATimeTest : public ::testing::Test {
 protected:
  void PostOne() {
    one_.PostBy(
        [this](std::function<void()> job) {
          if (takes_) jobs_.push_back(std::move(job));
          return takes_;
        },
        [this] { ++done_; });
  }

  bool takes_ = true;
  std::vector<std::function<void()>> jobs_;
  int done_ = 0;
  OneAtATime one_;
};

TEST_F(OneAtATimeTest, PostsNoOtherWhileOneWaits) {
  PostOne();
  PostOne();
  ASSERT_EQ(jobs_.size(), 1U);
  EXPECT_EQ(done_, 0);
}

TEST_F(OneAtATimeTest, PostsNoOtherWhileOneIsUnderWay) {
  one_.PostBy(
      [](const std::function<void()>& job) {
        job();
        return true;
      },
      [this] { PostOne(); });
  EXPECT_TRUE(jobs_.empty());
}

TEST_F(OneAtATimeTest, PostsTheNextOnceOneIsDone) {
  PostOne();
  jobs_.back()();
  PostOne();
  ASSERT_EQ(jobs_.size(), 2U);
  jobs_.back()();
  EXPECT_EQ(done_, 2);
}

TEST_F(OneAtATimeTest, PostsAgainWhereOneWasNotTaken) {
  takes_ = false;
  PostOne();
  takes_ = true;
  PostOne();
  EXPECT_EQ(jobs_.size(), 1U);
}

}  // namespace
}  // namespace uplink::loop
