#include "server/fleet/checkpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/judge.h"
#include "server/fleet/live_bytes.h"
#include "tests/support/manual_clock.h"
#include "tests/support/records.h"

namespace uplink::fleet {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::int64_t kNow = 1'763'683'200'000;

class CheckpointTest : public ::testing::Test {
 protected:
  Robot& Admit(const std::string& ruri) { return **fleet_.FindOrAdmit({ruri, "f"}); }
  static void Apply(Robot& robot, const model::Body& body) {
    std::vector<model::Record> records;
    records.push_back(test::RecordOf(body));
    robot.state.Apply(records);
  }
  static model::UsageTelemetry Usage(std::uint32_t reboots = 1) {
    return {.unix_time_ms = kNow, .reboot_count = reboots};
  }

  testing::ManualClock clock_;
  Fleet fleet_{clock_, 2'000, {}};
  Checkpoint checkpoint_{fleet_, [](std::string_view /*ruri*/) { return true; }};
  schema::Judge judge_{JudgeLimitsOfLive()};
};

TEST_F(CheckpointTest, TakesWhatChangedOnce) {
  Robot& robot = Admit("rcan://a");
  Admit("rcan://quiet");
  EXPECT_THAT(checkpoint_.TakeChanged(), IsEmpty()) << "nothing was told yet";
  Apply(robot, Usage());
  const auto rows = checkpoint_.TakeChanged();
  ASSERT_THAT(rows, SizeIs(1));
  EXPECT_EQ(rows[0].ruri, "rcan://a");
  EXPECT_THAT(checkpoint_.TakeChanged(), IsEmpty());
  EXPECT_THAT(checkpoint_.TakeChanged(), IsEmpty());
}

TEST_F(CheckpointTest, SignsOfLifeAndTheClockAreChanges) {
  Robot& robot = Admit("rcan://a");
  robot.state.SignOfLife(clock_.Steady(), clock_.System(), {});
  robot.state.NoteClockSkew(40);
  const auto rows = checkpoint_.TakeChanged();
  ASSERT_THAT(rows, SizeIs(1));
  EXPECT_EQ(rows[0].last_sign_of_life, clock_.System());
  EXPECT_EQ(rows[0].clock_skew_ms, 40);
  EXPECT_EQ(storage::BytesOf(rows[0]), 0U);
}

TEST_F(CheckpointTest, WhatWasPutBackIsTakenAgainWithWhatCameSince) {
  Robot& robot = Admit("rcan://a");
  Apply(robot, Usage(1));
  Apply(robot, model::SystemHealth{.unix_time_ms = kNow, .device_id = "main"});
  const auto rows = checkpoint_.TakeChanged();
  Apply(robot, Usage(2));
  checkpoint_.PutBack(rows);
  EXPECT_THAT(checkpoint_.TakeChanged(), IsEmpty()) << "the round is through";
  const auto again = checkpoint_.TakeChanged();
  ASSERT_THAT(again, SizeIs(1));
  const LiveRead read = FromRow(again[0], judge_);
  EXPECT_EQ(read.before.parts.usage->reboot_count, 2U);
  EXPECT_THAT(read.before.parts.health.items(), SizeIs(1));
}

TEST_F(CheckpointTest, TakesSomeAtATime) {
  constexpr std::size_t kRobots = storage::kCheckpointRowsMax * 2 + 1;
  for (std::size_t i = 0; i < kRobots; ++i) Apply(Admit("rcan://" + std::to_string(i)), Usage());
  EXPECT_THAT(checkpoint_.TakeChanged(), SizeIs(storage::kCheckpointRowsMax));
  EXPECT_THAT(checkpoint_.TakeChanged(), SizeIs(storage::kCheckpointRowsMax));
  EXPECT_THAT(checkpoint_.TakeChanged(), SizeIs(1));
  EXPECT_THAT(checkpoint_.TakeChanged(), IsEmpty());
}

TEST_F(CheckpointTest, TakesFewerWhereTheyAreLarge) {
  for (int i = 0; i < 40; ++i) {
    Robot& robot = Admit("rcan://" + std::to_string(i));
    for (int key = 0; key < 80; ++key) {
      Apply(robot, model::TelemetryExtras{.unix_time_ms = kNow,
                                          .kv = {{.key = std::to_string(key),
                                                  .value = std::string(4'000, 't'),
                                                  .unix_time_ms = {}}}});
    }
  }
  std::size_t bytes = 0;
  for (const auto& row : checkpoint_.TakeChanged()) bytes += storage::BytesOf(row);
  EXPECT_GE(bytes, storage::kCheckpointBytesMax);
  EXPECT_LE(bytes, storage::kCheckpointBytesMax + kLivePartBytesMax);
}

TEST_F(CheckpointTest, LeavesTheRobotsOfOtherJournals) {
  Apply(Admit("rcan://a"), Usage());
  Apply(Admit("rcan://b"), Usage());
  Checkpoint only_b(fleet_, [](std::string_view ruri) { return ruri == "rcan://b"; });
  const auto rows = only_b.TakeChanged();
  ASSERT_THAT(rows, SizeIs(1));
  EXPECT_EQ(rows[0].ruri, "rcan://b");
  EXPECT_THAT(checkpoint_.TakeChanged(), SizeIs(1)) << "a is still to be written";
}

}  // namespace
}  // namespace uplink::fleet
