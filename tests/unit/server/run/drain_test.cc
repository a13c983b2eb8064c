#include "server/run/drain.h"

#include <memory>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/journal/turns.h"
#include "tests/support/kept_lines.h"
#include "tests/support/server_world.h"

namespace uplink::run {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A drain of a world without a transport; what it does there is written down in order.
class DrainTest : public ::testing::Test {
 protected:
  void Run() {
    Drain({.clock = world_.clock,
           .logger = logger_,
           .ledgers = world_.ledgers,
           .fleet = world_.fleet,
           .journals = world_.shards,
           .monitor = world_.monitor,
           .signal = signal_,
           .transport = {.streams = [this] { return streams_; },
                         .drain = [this](milliseconds) { lines_.emplace_back("drain"); },
                         .wait_for_streams =
                             [this](milliseconds wait) {
                               EXPECT_TRUE(world_.monitor.draining()) << "no stream comes";
                               lines_.emplace_back("wait");
                               world_.clock.Advance(wait);
                               return streams_ == 0;
                             }},
           .leave =
               [this] {
                 lines_.emplace_back("leave");
                 return others_;
               },
           .stop_adopting = [] {},
           .stop = [this] { lines_.emplace_back("stop"); },
           .timeout = std::chrono::seconds(20)})
        .Run();
  }

  testing::ServerWorld world_;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), world_.clock,
                      log::Format::kText, log::Level::kInfo};
  StopSignal signal_{logger_, [](int /*signal*/) {}};
  std::size_t streams_ = 0;
  bool others_ = false;
};

TEST(ExitWait, IsWhatThePagesAndTheUnitSay) {
  // docs/operate/server.md; tests/e2e/test_docs.py compares unit, chart and compose files.
  EXPECT_EQ(kExitWait, std::chrono::seconds(7));
}

TEST_F(DrainTest, EndsTheStreamsThenStops) {
  Run();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("draining streams=0 timeout_ms=20000"), "drain", "wait",
                                  "leave", "stop", HasSubstr("stopped")));
}

TEST_F(DrainTest, TellsOfStreamsThatAreLeft) {
  streams_ = 3;
  Run();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("draining streams=3"), "drain", "wait",
                                  HasSubstr("streams_left streams=3"), "leave", "stop",
                                  HasSubstr("stopped")));
}

TEST_F(DrainTest, CountsWhatIsUnsettled) {
  metrics::MessageCounts counts;
  counts.received = 2;
  counts.in_flight = 2;
  world_.ledgers.NewPage().Publish(counts);
  Run();
  EXPECT_THAT(lines_.back(), HasSubstr("stopped_unsettled uplinks=2"));
}

/// A robot that is held and online.
class DrainOfHeld : public DrainTest {
 protected:
  DrainOfHeld() {
    world_.AddRobot("rcan://never");
    world_.journal.Open(heard_, 1, {.robot = heard_.id(), .at = world_.clock.System()});
    static_cast<void>(world_.journal.turns().Advance());
    heard_.state.SignOfLife(world_.clock.Steady(), world_.clock.System(),
                            world_.fleet.presence_limits());
    static_cast<void>(world_.journal.turns().Advance());
  }
  void RunUntilTheClockEndsIt() {
    // Nothing writes here, so the end of the wait for the journals has to come by the clock.
    const std::jthread time([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        world_.clock.Advance(std::chrono::seconds(1));
        std::this_thread::yield();
      }
    });
    Run();
  }

  robot::Robot& heard_ = world_.AddRobot("rcan://heard");
};

TEST_F(DrainOfHeld, NobodyListensAnyMoreSoPresenceIsUnknown) {
  ASSERT_EQ(heard_.state.presence(), model::Presence::kOnline);
  ASSERT_TRUE(world_.shards.idle());
  RunUntilTheClockEndsIt();
  EXPECT_FALSE(world_.shards.idle()) << "the change waits to be written";
}

TEST_F(DrainOfHeld, AStoreThatShutsTheProgramOutIsNotWaitedForLong) {
  world_.store.FailNextCommits(1, testing::FailAt::kBefore, absl::UnimplementedError("newer"));
  world_.journal.NotePresence(heard_.id(), model::Presence::kUnknown, world_.clock.System());
  EXPECT_EQ(world_.journal.turns().Advance(), journal::Step::kFailed);
  RunUntilTheClockEndsIt();
  EXPECT_THAT(lines_.front(), HasSubstr("timeout_ms=2000"));
}

TEST_F(DrainOfHeld, WhoIsOfflineStaysSo) {
  // Sweeps that come in time: nothing stood still.
  for (milliseconds passed{0}; passed <= world_.fleet.presence_limits().timeout;
       passed += std::chrono::seconds(1)) {
    world_.clock.Advance(std::chrono::seconds(1));
    world_.fleet.Sweep(std::chrono::hours(1));
  }
  ASSERT_EQ(heard_.state.presence(), model::Presence::kOffline);
  static_cast<void>(world_.journal.turns().Advance());
  RunUntilTheClockEndsIt();
  EXPECT_TRUE(world_.shards.idle()) << "nothing waits to be written";
}

TEST_F(DrainOfHeld, WhoTakesTheRobotsOverGoesOnWithTheirPresence) {
  others_ = true;
  RunUntilTheClockEndsIt();
  EXPECT_TRUE(world_.shards.idle());
}

TEST_F(DrainOfHeld, NothingIsSaidOfWhatAnotherHolds) {
  heard_.state.Lose();
  RunUntilTheClockEndsIt();
  EXPECT_TRUE(world_.shards.idle());
}

}  // namespace
}  // namespace uplink::run
