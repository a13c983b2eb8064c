#include "server/store/oldest_snapshot.h"

#include <functional>
#include <vector>

#include <gtest/gtest.h>

namespace uplink::store {
namespace {

class OldestSnapshotTest : public ::testing::Test {
 protected:
  void Ask() {
    snapshot_.AskOn([this](std::function<void()> job) {
      if (takes_jobs_) jobs_.push_back(std::move(job));
      return takes_jobs_;
    });
  }
  absl::StatusOr<milliseconds> answer_ = milliseconds(7);
  bool takes_jobs_ = true;
  std::vector<std::function<void()>> jobs_;
  OldestSnapshot snapshot_{[this] { return answer_; }};
};

TEST_F(OldestSnapshotTest, KeepsTheLastAnswerWhileThereIsNone) {
  EXPECT_EQ(snapshot_.age(), milliseconds(0));
  Ask();
  jobs_.back()();
  EXPECT_EQ(snapshot_.age(), milliseconds(7));
  answer_ = absl::UnavailableError("away");
  Ask();
  jobs_.back()();
  EXPECT_EQ(snapshot_.age(), milliseconds(7));
}

TEST_F(OldestSnapshotTest, OneJobIsUnderWayAtATime) {
  Ask();
  Ask();
  EXPECT_EQ(jobs_.size(), 1U);
  jobs_.back()();
  Ask();
  EXPECT_EQ(jobs_.size(), 2U);
}

TEST_F(OldestSnapshotTest, AJobThatIsNotTakenIsAskedForAgain) {
  takes_jobs_ = false;
  Ask();
  takes_jobs_ = true;
  Ask();
  EXPECT_EQ(jobs_.size(), 1U);
}

TEST(OldestSnapshotOfNothing, AsksNobody) {
  OldestSnapshot snapshot(nullptr);
  snapshot.AskOn([](const auto& /*job*/) -> bool {
    ADD_FAILURE();
    return true;
  });
  EXPECT_EQ(snapshot.age(), milliseconds(0));
}

}  // namespace
}  // namespace uplink::store
