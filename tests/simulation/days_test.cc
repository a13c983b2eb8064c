#include "tests/simulation/days.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::simulation {
namespace {

constexpr DaysOptions kOptions{.days = 16, .robots = 6, .history_days = 4, .quarantine_days = 2};
/// Each robot works two of three hours.
constexpr std::int64_t kVisitsADay = 6 * 24 * 2 / 3;

class DaysTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { days_ = Days(kOptions).Run(); }
  static std::int64_t Rows(std::size_t day, const std::string& table) {
    return days_.at(day).rows.at(table);
  }
  static std::size_t Last() { return days_.size() - 1; }

  static inline std::vector<DayFigures> days_;
};

TEST_F(DaysTest, HistoriesGrowUntilRetentionAndNoFurther) {
  for (const char* table : {"events", "messages", "faults_history", "mission_reports"}) {
    SCOPED_TRACE(table);
    EXPECT_EQ(Rows(0, table), kVisitsADay);
    EXPECT_EQ(Rows(2, table), 3 * kVisitsADay);
    // Whole days count, and the day at hand: one or two more than are kept.
    EXPECT_LE(Rows(Last(), table), (kOptions.history_days + 2) * kVisitsADay);
    EXPECT_GE(Rows(Last(), table), kOptions.history_days * kVisitsADay);
    EXPECT_EQ(Rows(Last(), table), Rows(Last() - 3, table));
  }
  EXPECT_LE(Rows(Last(), "quarantine"), (kOptions.quarantine_days + 2) * kVisitsADay);
  EXPECT_GE(Rows(Last(), "quarantine"), kOptions.quarantine_days * kVisitsADay);
}

TEST_F(DaysTest, WhatIsPresentStaysAsManyAsThereAre) {
  for (std::size_t day = 1; day <= Last(); ++day) {
    SCOPED_TRACE(day);
    EXPECT_EQ(Rows(day, "robots"), kOptions.robots);
    EXPECT_EQ(Rows(day, "presence_latest"), kOptions.robots);
    // The last eight of each robot, and that of the process.
    EXPECT_LE(Rows(day, "sessions"), kOptions.robots * 8 + 1);
    // Half an hour each, and an hour until the next look.
    EXPECT_LE(Rows(day, "objects"), 2 * kOptions.robots);
    EXPECT_LE(Rows(day, "faults_active"), kOptions.robots);
  }
}

TEST_F(DaysTest, EachVisitIsOnlineAndThenOffline) {
  EXPECT_EQ(Rows(0, "presence_changes"), 2 * kVisitsADay);
  EXPECT_LE(Rows(Last(), "presence_changes"), (kOptions.history_days + 2) * 2 * kVisitsADay);
}

TEST_F(DaysTest, TheFileIsUsedAgain) {
  EXPECT_LE(days_[Last()].file_kib, days_[8].file_kib * 11 / 10);
}

}  // namespace
}  // namespace uplink::simulation
