#include "server/store/writers.h"

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/model/ids.h"
#include "server/journal/turns.h"
#include "storage/connection.h"
#include "tests/support/eventually.h"
#include "tests/support/fake_store.h"
#include "tests/unit/server/log/line_recorder.h"

namespace uplink::store {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class WritersTest : public ::testing::Test {
 protected:
  static constexpr std::size_t kStores = 2;

  WritersTest() {
    for (std::uint8_t i = 0; i < kStores; ++i) {
      stores_[i] = std::make_unique<testing::FakeStore>(database_, storage::ProcessId{1});
    }
  }

  std::unique_ptr<Writers> Make() {
    return std::make_unique<Writers>(
        stores_,
        Writers::Context{
            .clock = clock_, .ledgers = ledgers_, .probe = probe_, .fleet = fleet_, .random = [] {
              return std::uint64_t{0};
            }});
  }

  SystemClock clock_;
  testing::FakeDatabase database_;
  std::array<std::unique_ptr<storage::Store>, kStores> stores_;
  metrics::LedgerBook ledgers_;
  journal::JournalProbe probe_;
  fleet::Fleet fleet_{clock_, 5, {}};
};

TEST_F(WritersTest, AJournalStandsBeforeEachStore) {
  EXPECT_EQ(Make()->journals().all().size(), kStores);
}

TEST_F(WritersTest, EachJournalIsWrittenOnceTheyRun) {
  const auto writers = Make();
  for (const char* ruri : {"rcan://a", "rcan://b", "rcan://c", "rcan://d"}) {
    robot::Robot& robot = **fleet_.FindOrAdmit({ruri, "f"});
    writers->journals().Of(ruri).Open(robot, 1, {.robot = robot.id(), .at = clock_.System()});
  }
  EXPECT_FALSE(writers->journals().idle());
  writers->Start();
  EXPECT_TRUE(testing::Eventually([&] { return writers->journals().idle(); }));
  writers->Stop();
  writers->Stop();
}

TEST_F(WritersTest, ARobotThatMovesToAnotherFleetIsALineOfTheLog) {
  const log::testing::RecordedLog log(clock_, log::Format::kText, log::Level::kInfo);
  std::vector<std::string> told;
  Writers writers(stores_, {.clock = clock_,
                            .ledgers = ledgers_,
                            .probe = probe_,
                            .fleet = fleet_,
                            .random = [] { return std::uint64_t{0}; },
                            .logger = &log.logger,
                            .moved =
                                [&told](const journal::Moved& moved) {
                                  told.push_back(moved.ruri + " to " + moved.to);
                                }});
  const auto come = [&](const std::string& fleet, std::string gateway) {
    robot::Robot& robot = **fleet_.FindOrAdmit({"rcan://bench/1", fleet});
    journal::Journal& journal = writers.journals().Of(robot.ruri());
    journal.Open(robot, 1, {.robot = robot.id(), .at = clock_.System()}, std::move(gateway));
    while (journal.turns().Advance() == journal::Step::kWorked) {
    }
  };
  come("north", "");
  come("north", "CN=hall");
  EXPECT_THAT(log.lines, IsEmpty());
  come("south", "CN=hall");
  EXPECT_THAT(
      log.lines,
      ElementsAre(EndsWith(
          " info robot_moved robot=rcan://bench/1 from=north to=south gateway=\"CN=hall\"")));
  EXPECT_THAT(told, ElementsAre("rcan://bench/1 to south"));
}

TEST_F(WritersTest, AConnectionThatIsNotKeptIsALineOfTheLog) {
  const log::testing::RecordedLog log(clock_, log::Format::kText, log::Level::kInfo);
  Writers writers(stores_, {.clock = clock_,
                            .ledgers = ledgers_,
                            .probe = probe_,
                            .fleet = fleet_,
                            .random = [] { return std::uint64_t{0}; },
                            .limits = {.connections_max = 0},
                            .logger = &log.logger});
  storage::ConnectionItem item;
  item.robot = std::make_shared<const model::RobotId>(model::RobotId{"rcan://bench/1", "f"});
  for (std::uint8_t id = 0; id < 3; ++id) {
    item.id = {id};
    writers.journals().NoteConnection(item);
  }
  // One waits: each shard has room for one.
  EXPECT_THAT(log.lines, SizeIs(2));
  EXPECT_THAT(log.lines, Each(EndsWith(" warn connection_dropped robot=rcan://bench/1")));
  EXPECT_EQ(probe_.connections_dropped.value(), 2);
}

class WritersReconnect : public WritersTest {
 protected:
  WritersReconnect() {
    const SteadyTime long_ago = clock_.Steady() - limits_.timeout - milliseconds(1);
    robot_->state.SignOfLife(long_ago, clock_.System(), limits_);
  }
  /// What the robot is after each store was connected to anew. The fleet is told before the other
  /// part, so it was told.
  robot::Presence AfterReconnect(const std::function<void()>& meanwhile = [] {}) {
    std::atomic<std::size_t> told{0};
    Writers writers(stores_, {.clock = clock_,
                              .ledgers = ledgers_,
                              .probe = probe_,
                              .fleet = fleet_,
                              .random = [] { return std::uint64_t{0}; },
                              .store_reconnected = [&told] { ++told; }});
    for (journal::Journal* journal : writers.journals().all()) {
      // It knows the server by then.
      while (journal->turns().Advance() != journal::Step::kIdle) {
      }
    }
    meanwhile();
    for (const auto& store : stores_) static_cast<testing::FakeStore&>(*store).Break();
    writers.Start();
    EXPECT_TRUE(testing::Eventually([&told] { return told.load() == kStores; }));
    writers.Stop();
    fleet_.Sweep(std::chrono::hours(1));
    return robot_->state.presence();
  }

  const robot::PresenceLimits& limits_ = fleet_.presence_limits();
  const fleet::RobotPtr robot_ = *fleet_.FindOrAdmit({"rcan://a", "f"});
};

TEST_F(WritersReconnect, SilenceUntilAStoreWasReplacedCountsNot) {
  testing::FakeDatabase standby;
  standby.CopyRowsOf(database_);
  EXPECT_EQ(AfterReconnect([&] { database_.CopyRowsOf(standby); }), robot::Presence::kUnknown);
}

TEST_F(WritersReconnect, SilenceCountsThoughSessionsWithTheSameServerEnded) {
  EXPECT_EQ(AfterReconnect(), robot::Presence::kOffline);
}

TEST_F(WritersTest, StopWithoutAStartDoesNothing) { Make()->Stop(); }

}  // namespace
}  // namespace uplink::store
