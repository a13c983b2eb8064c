// Robots that come and go on several threads, while others leave memory.
#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "server/fleet/forgetting.h"
#include "server/journal/shards.h"
#include "server/journal/writer.h"
#include "tests/support/eventually.h"
#include "tests/support/fake_store.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::fleet {
namespace {

constexpr std::size_t kRobotsMax = 6;
constexpr int kRobots = 20;
constexpr int kThreads = 3;
constexpr int kVisits = 400;

struct NoInbox final : loop::WakeInbox {
  void Wake(std::uint64_t /*stream*/) override {}
};

struct World {
  World() {
    fleet.OnPresence(
        [this](const storage::RobotRef& robot, const storage::StoredPresence& now, auto why) {
          journals.NotePresence(robot, now.presence, now.since, why, now.parked_until);
        });
  }

  testing::ManualClock clock;
  testing::FakeDatabase database;
  testing::FakeStore store{database, storage::ProcessId{1}};
  metrics::Ledger ledger;
  journal::JournalProbe probe;
  Fleet fleet{clock, kRobotsMax, {}};
  journal::Journal journal{store, {}, clock, ledger, probe, storage::ProcessId{1}};
  journal::Shards journals{{&journal}};
  std::vector<std::string> lines;
  log::Logger logger{std::make_unique<testing::KeptLines>(lines), clock, log::Format::kText,
                     log::Level::kInfo};
  NoInbox inbox;
  std::atomic<std::uint64_t> streams{0};
  std::atomic<int> admitted{0};
  std::atomic<int> refused{0};
};

/// A stream of the robot comes and goes.
void Visit(World& world, int robot_number) {
  const auto robot = world.fleet.FindOrAdmit({std::to_string(robot_number), "f"});
  if (!robot.ok()) {
    ++world.refused;
    return;
  }
  ++world.admitted;
  const loop::StreamRef stream{&world.inbox, ++world.streams};
  const SteadyTime now = world.clock.Steady();
  (*robot)->NoteHeard(world.clock.System());
  const auto attached = (*robot)->sessions.Attach(stream, now, world.clock.System());
  const auto begun = attached.standing == robot::Standing::kCurrent
                         ? (*robot)->sessions.Begin(model::SessionId({1}), now)
                         : std::nullopt;
  if (begun) {
    (*robot)->state.Claim(now);
    world.journal.Open(
        **robot, begun->open_id,
        {.robot = (*robot)->id(), .session = model::SessionId({1}), .at = world.clock.System()});
    (*robot)->state.SignOfLife(now, world.clock.System(), world.fleet.presence_limits());
  }
  (*robot)->sessions.Detach(stream, now);
  if (!(*robot)->HasStream()) (*robot)->state.EndClaim();
}

TEST(ForgettingThreads, RobotsThatComeAndGoAndLeaveAllGoInTheEnd) {
  World world;
  Forgetting forgetting({.fleet = world.fleet,
                         .clock = world.clock,
                         .logger = world.logger,
                         .forget_after = std::chrono::seconds(20),
                         .clock_vouched = [] { return true; },
                         .release =
                             [&world](robot::Robot& robot) {
                               world.journals.Leave({.client = &robot, .robot = robot.id()});
                             }});
  journal::JournalWriter writer(world.journal, {}, [] { return std::uint64_t{0}; });
  const auto round = [&] {
    world.clock.Advance(std::chrono::seconds(1));
    world.fleet.Sweep(std::chrono::hours(1));
    forgetting.Round();
  };
  std::atomic<int> running{kThreads};
  std::vector<std::jthread> threads;
  threads.reserve(kThreads);
  for (int thread = 0; thread < kThreads; ++thread) {
    threads.emplace_back([&world, &running, thread] {
      for (int visit = 0; visit < kVisits; ++visit) Visit(world, (visit * (thread + 1)) % kRobots);
      --running;
    });
  }
  while (running.load() > 0) round();
  EXPECT_TRUE(testing::Eventually([&] {
    round();
    return world.fleet.All().empty();
  }));
  EXPECT_EQ(world.fleet.size(), 0U);
  EXPECT_GT(world.admitted.load(), kRobots);
  EXPECT_GT(world.fleet.forgotten(), 0U);
  writer.Stop();
}

}  // namespace
}  // namespace uplink::fleet
