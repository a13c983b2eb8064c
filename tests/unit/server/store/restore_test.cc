#include "server/store/restore.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "server/robot/live_bytes.h"
#include "tests/support/fake_store.h"
#include "tests/support/manual_clock.h"
#include "tests/support/records.h"
#include "tests/support/switched_reader.h"
#include "tests/unit/server/store/known_robot.h"

namespace uplink::store {
namespace {

class RestoreTest : public ::testing::Test {
 protected:
  RestoreTest() {
    for (const char* ruri : {"rcan://a", "rcan://b"}) {
      Know(store_, ruri, clock_.System());
      EXPECT_TRUE(fleet_.FindOrAdmit({ruri, "f"}).ok());
    }
  }
  /// This process holds both from now on.
  void Begin(storage::Epoch since = 2) {
    for (const fleet::RobotPtr& robot : fleet_.All())
      robot->OnHeld({.since = since, .was_known = true});
  }
  static storage::LiveRow Live(const std::string& ruri, std::uint32_t reboots) {
    robot::LiveChanges changes;
    changes.changed.set(static_cast<std::size_t>(storage::LivePart::kUsage));
    changes.parts.usage = model::UsageTelemetry{.unix_time_ms = 5, .reboot_count = reboots};
    changes.last_sign_of_life = FromUnixMs(1'763'683'200'000);
    return robot::ToRow(ruri, changes);
  }
  /// Under the robot's hold in the store.
  void Checkpoint(storage::LiveRow row) {
    row.held_since = database_.EpochOf(row.ruri);
    ASSERT_TRUE(store_.Checkpoint({&row, 1}).ok());
  }
  robot::StateSnapshot State(const std::string& ruri) {
    return fleet_.Find(ruri)->state.Snapshot(robot::RobotState::Parts::kAll);
  }

  testing::ManualClock clock_;
  testing::FakeDatabase database_;
  testing::FakeStore store_{database_, storage::ProcessId{1}};
  testing::SwitchedReader reader_{store_};
  fleet::Fleet fleet_{clock_, 2, {}};
  Restore restore_{fleet_, reader_};
};

TEST_F(RestoreTest, NothingIsDueUntilARobotIsHeld) {
  Checkpoint(Live("rcan://a", 4));
  EXPECT_FALSE(restore_.due());
  EXPECT_TRUE(restore_.Run().ok());
  EXPECT_FALSE(State("rcan://a").parts.usage);
  Begin();
  EXPECT_TRUE(restore_.due());
}

TEST_F(RestoreTest, RobotsComeWithTheirLastCheckpoint) {
  Checkpoint(Live("rcan://a", 4));
  Begin();
  ASSERT_TRUE(restore_.Run().ok());
  EXPECT_EQ(State("rcan://a").parts.usage->reboot_count, 4U);
  EXPECT_EQ(State("rcan://a").last_sign_of_life, FromUnixMs(1'763'683'200'000));
  EXPECT_EQ(State("rcan://a").presence, robot::Presence::kUnknown);
  EXPECT_FALSE(State("rcan://b").last_sign_of_life);
  EXPECT_EQ(restore_.left_out(), 0U);
  EXPECT_FALSE(restore_.due()) << "neither of them, though one had nothing";
}

TEST_F(RestoreTest, ManyAreRestoredAPortionAtATime) {
  fleet::Fleet fleet{clock_, kRestoredAtOnceMax + 1, {}};
  for (std::size_t i = 0; i <= kRestoredAtOnceMax; ++i) {
    const std::string ruri = "rcan://many/" + std::to_string(1'000 + i);
    Know(store_, ruri, clock_.System());
    Checkpoint(Live(ruri, 4));
    ASSERT_TRUE(fleet.FindOrAdmit({ruri, "f"}).ok());
  }
  for (const fleet::RobotPtr& robot : fleet.All()) robot->OnHeld({.since = 2, .was_known = true});
  Restore restore{fleet, reader_};
  ASSERT_TRUE(restore.Run().ok());
  EXPECT_FALSE(restore.due());
  for (const fleet::RobotPtr& robot : fleet.All()) {
    const auto state = robot->state.Snapshot(robot::RobotState::Parts::kAll);
    ASSERT_TRUE(state.parts.usage) << robot->ruri();
  }
}

TEST_F(RestoreTest, WhatItToldHereIsNewer) {
  Checkpoint(Live("rcan://a", 4));
  Begin();
  std::vector<model::Record> records;
  records.push_back(test::RecordOf(model::UsageTelemetry{.unix_time_ms = 6, .reboot_count = 5}));
  fleet_.Find("rcan://a")->state.Apply(records, {});
  ASSERT_TRUE(restore_.Run().ok());
  EXPECT_EQ(State("rcan://a").parts.usage->reboot_count, 5U);
}

TEST_F(RestoreTest, WhatThisVersionDoesNotPassIsCounted) {
  storage::LiveRow row = Live("rcan://a", 4);
  row.parts[0] = "no message";
  Checkpoint(row);
  Begin();
  ASSERT_TRUE(restore_.Run().ok());
  EXPECT_EQ(restore_.left_out(), 1U);
  EXPECT_TRUE(State("rcan://a").parts.usage);
}

TEST_F(RestoreTest, IsTriedAgainWhileTheStoreIsAway) {
  Checkpoint(Live("rcan://a", 4));
  Begin();
  reader_.SetAway(true);
  EXPECT_FALSE(restore_.Run().ok());
  EXPECT_TRUE(restore_.due());
  reader_.SetAway(false);
  EXPECT_TRUE(restore_.Run().ok());
  EXPECT_TRUE(State("rcan://a").parts.usage);
}

TEST_F(RestoreTest, ARobotThatIsLostAgainHasNothingToRestore) {
  Checkpoint(Live("rcan://a", 4));
  Begin();
  for (const fleet::RobotPtr& robot : fleet_.All()) robot->state.Lose();
  EXPECT_FALSE(restore_.due());
  ASSERT_TRUE(restore_.Run().ok());
  EXPECT_FALSE(State("rcan://a").parts.usage);
}

TEST_F(RestoreTest, RobotsComeWithWhatTheirReportsSay) {
  Know(store_, "rcan://a", clock_.System());
  Know(store_, "rcan://b", clock_.System());
  const auto commit = [this](model::Seq seq, const model::Body& body) {
    const storage::OpenRequest open{
        std::make_shared<const model::RobotId>(model::RobotId{"rcan://a", "f"}),
        model::SessionId({1}),
        0,
        clock_.System(),
        {}};
    const auto opened = store_.OpenStreams({&open, 1});
    ASSERT_TRUE(opened.ok());
    storage::Batch batch;
    batch.records.push_back({.robot = open.robot,
                             .session = open.session,
                             .seq = seq,
                             .held_since = opened->front().held_since,
                             .received_at = clock_.System(),
                             .content = test::RecordOf(body)});
    ASSERT_TRUE(store_.Commit(batch).ok());
    clock_.Advance(std::chrono::seconds(1));
  };
  model::AgentInfo info{.agent_version = "1.2", .software_version = "7"};
  info.uptime_s = 100;
  const SystemTime told_at = clock_.System();
  commit(1, info);
  const auto run = [](const std::string& id, std::uint16_t progress, model::MissionStatus status) {
    model::MissionRunStatus body;
    body.mission_id = "m";
    body.run_id = id;
    body.progress_x100 = progress;
    body.status = status;
    return body;
  };
  commit(2, run("first", 100, model::MissionStatus::kRunning));
  commit(3, run("second", 200, model::MissionStatus::kRunning));
  commit(4, run("third", 300, model::MissionStatus::kComplete));
  commit(5, run("first", 4250, model::MissionStatus::kRunning));
  Begin();
  ASSERT_TRUE(restore_.Run().ok());
  fleet_.Find("rcan://a")->state.LookAt([&](const robot::StateView& view) {
    EXPECT_EQ(view.reported.booted_at, told_at - std::chrono::seconds(100));
    EXPECT_EQ(view.reported.agent_version, "1.2");
    EXPECT_EQ(view.reported.software_version, "7");
    const auto& runs = view.reported.open_runs.items();
    ASSERT_EQ(runs.size(), 2U);
    EXPECT_EQ(runs.back().first, "m/first") << "the latest report, not the latest run";
    EXPECT_EQ(runs.back().second, 42.5);
    EXPECT_EQ(runs.front().second, 2);
  });
  fleet_.Find("rcan://b")->state.LookAt([&](const robot::StateView& view) {
    EXPECT_FALSE(view.reported.booted_at);
    EXPECT_TRUE(view.reported.open_runs.items().empty());
  });
}

}  // namespace
}  // namespace uplink::store
