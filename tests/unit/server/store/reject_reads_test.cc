#include "server/store/reject_reads.h"

#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/fake_reader.h"
#include "tests/support/switched_reader.h"

namespace uplink::store {
namespace {

class RejectReadsTest : public ::testing::Test {
 protected:
  using Answer = absl::StatusOr<std::vector<storage::StoredReject>>;
  [[nodiscard]] bool Ask() {
    return reads_.Read({.ruri = "rcan://reads/1", .through = 9},
                       [this](Answer answer) { answer_ = std::move(answer); });
  }

  testing::FakeDatabase database_;
  testing::FakeReader rows_{database_};
  testing::SwitchedReader reader_{rows_};
  bool takes_jobs_ = true;
  std::vector<std::function<void()>> jobs_;
  RejectReads reads_{reader_, [this](std::function<void()> job) {
                       if (takes_jobs_) jobs_.push_back(std::move(job));
                       return takes_jobs_;
                     }};
  std::optional<Answer> answer_;
};

TEST_F(RejectReadsTest, ReadsInAJob) {
  EXPECT_TRUE(Ask());
  EXPECT_EQ(reader_.calls(), 0) << "the caller does not wait for the store";
  ASSERT_EQ(jobs_.size(), 1U);
  jobs_.front()();
  EXPECT_EQ(reader_.calls(), 1);
  ASSERT_TRUE(answer_.has_value());
  EXPECT_TRUE(answer_->ok());
}

TEST_F(RejectReadsTest, TellsThatTheStoreIsAway) {
  reader_.SetAway(true);
  EXPECT_TRUE(Ask());
  jobs_.front()();
  ASSERT_TRUE(answer_.has_value());
  EXPECT_FALSE(answer_->ok());
}

TEST_F(RejectReadsTest, IsRefusedWhereNoJobIsTaken) {
  takes_jobs_ = false;
  EXPECT_FALSE(Ask());
  EXPECT_FALSE(answer_.has_value());
}

}  // namespace
}  // namespace uplink::store
