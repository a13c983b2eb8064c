#include "server/journal/store_errors.h"

#include <gtest/gtest.h>

namespace uplink::journal {
namespace {

class StoreErrorsTest : public ::testing::Test {
 protected:
  const absl::Status away_ = absl::UnavailableError("away");
  const absl::Status full_ = absl::ResourceExhaustedError("full");
  JournalProbe probe_;
  StoreErrors errors_{probe_};
};

TEST_F(StoreErrorsTest, ThereIsNoneAtFirst) {
  EXPECT_TRUE(errors_.last().ok());
  errors_.NoteCall(absl::OkStatus());
  errors_.NoteDuty(absl::OkStatus());
  EXPECT_EQ(probe_.store_errors.value(), 0);
  EXPECT_EQ(probe_.store_failing.value(), 0);
}

TEST_F(StoreErrorsTest, EveryErrorCountsAndTheJournalOnce) {
  errors_.NoteCall(away_);
  errors_.NoteCall(full_);
  errors_.NoteDuty(away_);
  EXPECT_EQ(probe_.store_errors.value(), 3);
  EXPECT_EQ(probe_.store_failing.value(), 1);
  EXPECT_EQ(errors_.last(), full_) << "of what robots wait for";
}

TEST_F(StoreErrorsTest, ThatADutyWorksSaysNothingOfCalls) {
  errors_.NoteCall(full_);
  errors_.NoteDuty(absl::OkStatus());
  EXPECT_EQ(errors_.last(), full_);
  EXPECT_EQ(probe_.store_failing.value(), 1);
}

TEST_F(StoreErrorsTest, ACallThatWorksShowsThatTheStoreIsThere) {
  errors_.NoteDuty(away_);
  EXPECT_EQ(errors_.last(), away_);
  EXPECT_EQ(probe_.store_failing.value(), 1);
  errors_.NoteCall(absl::OkStatus());
  EXPECT_TRUE(errors_.last().ok());
  EXPECT_EQ(probe_.store_failing.value(), 0);
}

TEST_F(StoreErrorsTest, AComparisonThatWorksSaysNothingOfCallsAndEndsADutysError) {
  errors_.NoteCompare(away_);
  EXPECT_EQ(errors_.last(), away_);
  errors_.NoteCompare(absl::OkStatus());
  EXPECT_TRUE(errors_.last().ok());
  errors_.NoteCall(full_);
  errors_.NoteCompare(away_);
  EXPECT_EQ(errors_.last(), away_) << "the latest";
  errors_.NoteCompare(absl::OkStatus());
  EXPECT_EQ(errors_.last(), away_) << "until the call works";
  EXPECT_EQ(probe_.store_failing.value(), 1);
  errors_.NoteCall(absl::OkStatus());
  EXPECT_EQ(probe_.store_failing.value(), 0);
}

TEST_F(StoreErrorsTest, OneProbeCountsEachThatFails) {
  StoreErrors others(probe_);
  errors_.NoteCall(away_);
  others.NoteDuty(away_);
  EXPECT_EQ(probe_.store_failing.value(), 2);
  others.NoteDuty(absl::OkStatus());
  EXPECT_EQ(probe_.store_failing.value(), 1);
}

}  // namespace
}  // namespace uplink::journal
