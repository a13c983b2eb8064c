#include "server/fleet/checkpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/judge.h"
#include "server/robot/live_bytes.h"
#include "tests/support/manual_clock.h"
#include "tests/support/records.h"

namespace uplink::fleet {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::int64_t kNow = 1'763'683'200'000;

class NoInbox final : public loop::WakeInbox {
 public:
  void Wake(std::uint64_t /*stream*/) override {}
};

class CheckpointTest : public ::testing::Test {
 protected:
  testing::ManualClock clock_;
  Fleet fleet_{clock_, 2'000, {}};

  /// A robot that this process holds.
  robot::Robot& Admit(const std::string& ruri) {
    robot::Robot& robot = **fleet_.FindOrAdmit({ruri, "f"});
    if (robot.state.held_since() == 0) robot.OnHeld({.since = 1});
    return robot;
  }
  static void Apply(robot::Robot& robot, const model::Body& body) {
    std::vector<model::Record> records;
    records.push_back(test::RecordOf(body));
    robot.state.Apply(records, {});
  }
  static model::UsageTelemetry Usage(std::uint32_t reboots = 1) {
    return {.unix_time_ms = kNow, .reboot_count = reboots};
  }

  /// The rows of one round, a call each.
  static std::vector<std::vector<storage::LiveRow>> Round(Checkpoint& checkpoint) {
    std::vector<std::vector<storage::LiveRow>> calls;
    checkpoint.BeginRound();
    while (true) {
      auto rows = checkpoint.TakeChanged(storage::kCheckpointRowsMax);
      if (rows.empty()) return calls;
      calls.push_back(std::move(rows));
    }
  }
  std::vector<storage::LiveRow> Changed() {
    std::vector<storage::LiveRow> all;
    for (const auto& rows : Round(checkpoint_)) all.insert(all.end(), rows.begin(), rows.end());
    return all;
  }
  Checkpoint::Sources Sources() {
    return {.fleet = fleet_, .writes = [](std::string_view /*ruri*/) { return true; }};
  }

  Checkpoint checkpoint_{Sources()};
  schema::Judge judge_{robot::JudgeLimitsOfLive()};
};

TEST_F(CheckpointTest, TakesWhatChangedOnce) {
  robot::Robot& robot = Admit("rcan://a");
  Admit("rcan://quiet");
  EXPECT_THAT(Changed(), IsEmpty()) << "nothing was told yet";
  Apply(robot, Usage());
  const auto rows = Changed();
  ASSERT_THAT(rows, SizeIs(1));
  EXPECT_EQ(rows[0].ruri, "rcan://a");
  EXPECT_EQ(rows[0].held_since, 1U);
  EXPECT_THAT(Changed(), IsEmpty());
}

TEST_F(CheckpointTest, WaitsUntilTheStoreSaysWhoseTheRobotIs) {
  robot::Robot& robot = **fleet_.FindOrAdmit({"rcan://a", "f"});
  Apply(robot, Usage());
  EXPECT_THAT(Changed(), IsEmpty());
  robot.OnHeld({.since = 7});
  EXPECT_EQ(Changed().at(0).held_since, 7U);
}

TEST_F(CheckpointTest, WritesNothingOfARobotBeforeWhatTheStoreHadOfItWasRead) {
  robot::Robot& known = **fleet_.FindOrAdmit({"rcan://known", "f"});
  known.OnHeld({.since = 1, .was_known = true});
  Apply(known, Usage());
  Apply(Admit("rcan://new"), Usage());
  EXPECT_EQ(Changed().at(0).ruri, "rcan://new") << "whatever cannot be read of others";
  EXPECT_THAT(Changed(), IsEmpty());
  known.state.SetRestored(1);
  EXPECT_EQ(Changed().at(0).ruri, "rcan://known");
}

TEST_F(CheckpointTest, HowFarTheSessionIsSettledIsAChange) {
  robot::Robot& robot = Admit("rcan://a");
  ASSERT_TRUE(robot.sessions.Begin(model::SessionId({1}), clock_.Steady()));
  robot.sessions.AddSettled(model::SessionId({1}), 3);
  const auto rows = Changed();
  ASSERT_THAT(rows, SizeIs(1));
  EXPECT_EQ(rows[0].session, (storage::SettledSession{model::SessionId({1}), 3}));
  EXPECT_FALSE(rows[0].last_sign_of_life);
  EXPECT_THAT(Changed(), IsEmpty());
  checkpoint_.PutBack(rows);
  EXPECT_EQ(Changed().at(0).session, rows[0].session);
}

TEST_F(CheckpointTest, SignsOfLifeAndTheClockAreChanges) {
  robot::Robot& robot = Admit("rcan://a");
  robot.state.SignOfLife(clock_.Steady(), clock_.System(), {});
  robot.state.NoteBatch({.sent_unix_ms = UnixMs(clock_.System()) + 40}, clock_.Steady(),
                        clock_.System());
  const auto rows = Changed();
  ASSERT_THAT(rows, SizeIs(1));
  EXPECT_EQ(rows[0].last_sign_of_life, clock_.System());
  EXPECT_EQ(rows[0].clock_skew_ms, 40);
  EXPECT_EQ(storage::BytesOf(rows[0]), 0U);
}

TEST_F(CheckpointTest, WhatWasPutBackIsTakenAgainWithWhatCameSince) {
  robot::Robot& robot = Admit("rcan://a");
  Apply(robot, Usage(1));
  Apply(robot, model::SystemHealth{.unix_time_ms = kNow, .device_id = "main"});
  const auto rows = Changed();
  Apply(robot, Usage(2));
  checkpoint_.PutBack(rows);
  const auto again = Changed();
  ASSERT_THAT(again, SizeIs(1));
  const robot::LiveRead read = robot::FromRow(again[0], judge_);
  EXPECT_EQ(read.before.parts.usage->reboot_count, 2U);
  EXPECT_THAT(read.before.parts.health.items(), SizeIs(1));
}

TEST_F(CheckpointTest, WhatWasPassedOverIsTakenAgainIfTheRobotHasAStreamHere) {
  robot::Robot& elsewhere = Admit("rcan://elsewhere");
  Apply(elsewhere, Usage());
  for (const auto& row : Changed()) checkpoint_.PassedOver(row);
  EXPECT_THAT(Changed(), IsEmpty());
  NoInbox inbox;
  robot::Robot& here = Admit("rcan://here");
  static_cast<void>(here.sessions.Attach({&inbox, 1}, clock_.Steady(), clock_.System()));
  Apply(here, Usage());
  for (const auto& row : Changed()) checkpoint_.PassedOver(row);
  EXPECT_THAT(Changed(), SizeIs(1));
}

TEST_F(CheckpointTest, ARoundThatWasBrokenOffIsBegunAnew) {
  for (int i = 0; i < 10; ++i) Apply(Admit("rcan://" + std::to_string(i)), Usage());
  checkpoint_.BeginRound();
  const auto first = checkpoint_.TakeChanged(4);
  ASSERT_THAT(first, SizeIs(4));
  checkpoint_.PutBack(first);
  EXPECT_THAT(Changed(), SizeIs(10));
}

TEST_F(CheckpointTest, TakesSomeAtATime) {
  constexpr std::size_t kRobots = storage::kCheckpointRowsMax * 2 + 1;
  for (std::size_t i = 0; i < kRobots; ++i) Apply(Admit("rcan://" + std::to_string(i)), Usage());
  const auto calls = Round(checkpoint_);
  ASSERT_THAT(calls, SizeIs(3));
  EXPECT_THAT(calls[0], SizeIs(storage::kCheckpointRowsMax));
  EXPECT_THAT(calls[2], SizeIs(1));
}

TEST_F(CheckpointTest, TakesFewerWhereTheyAreLarge) {
  for (int i = 0; i < 40; ++i) {
    robot::Robot& robot = Admit("rcan://" + std::to_string(i));
    for (int key = 0; key < 80; ++key) {
      Apply(robot, model::TelemetryExtras{.unix_time_ms = kNow,
                                          .kv = {{.key = std::to_string(key),
                                                  .value = std::string(4'000, 't'),
                                                  .unix_time_ms = {}}}});
    }
  }
  std::size_t bytes = 0;
  const auto calls = Round(checkpoint_);
  ASSERT_FALSE(calls.empty());
  for (const auto& row : calls[0]) bytes += storage::BytesOf(row);
  EXPECT_GE(bytes, storage::kCheckpointBytesMax);
  EXPECT_LE(bytes, storage::kCheckpointBytesMax + robot::kLivePartBytesMax);
}

TEST_F(CheckpointTest, LeavesTheRobotsOfOtherJournals) {
  Apply(Admit("rcan://a"), Usage());
  Apply(Admit("rcan://b"), Usage());
  Checkpoint::Sources sources = Sources();
  sources.writes = [](std::string_view ruri) { return ruri == "rcan://b"; };
  Checkpoint only_b(sources);
  const auto calls = Round(only_b);
  ASSERT_THAT(calls, SizeIs(1));
  ASSERT_THAT(calls[0], SizeIs(1));
  EXPECT_EQ(calls[0][0].ruri, "rcan://b");
  EXPECT_THAT(Changed(), SizeIs(1)) << "a is still to be written";
}

}  // namespace
}  // namespace uplink::fleet
