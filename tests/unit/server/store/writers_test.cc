#include "server/store/writers.h"

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "tests/support/eventually.h"
#include "tests/support/fake_store.h"

namespace uplink::store {
namespace {

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

/// The fleet was told before the other part, so it was told.
TEST_F(WritersTest, SilenceUntilAStoreWasConnectedToAnewCountsNot) {
  robot::Robot& robot = **fleet_.FindOrAdmit({"rcan://a", "f"});
  const robot::PresenceLimits& limits = fleet_.presence_limits();
  const SteadyTime long_ago = clock_.Steady() - limits.timeout - milliseconds(1);
  robot.state.SignOfLife(long_ago, clock_.System(), limits);
  std::atomic<bool> told{false};
  Writers writers(stores_, {.clock = clock_,
                            .ledgers = ledgers_,
                            .probe = probe_,
                            .fleet = fleet_,
                            .random = [] { return std::uint64_t{0}; },
                            .store_reconnected = [&told] { told = true; }});
  for (const auto& store : stores_) static_cast<testing::FakeStore&>(*store).Break();
  writers.Start();
  EXPECT_TRUE(testing::Eventually([&told] { return told.load(); }));
  fleet_.Sweep(std::chrono::hours(1));
  EXPECT_EQ(robot.state.presence(), robot::Presence::kUnknown);
  writers.Stop();
}

TEST_F(WritersTest, StopWithoutAStartDoesNothing) { Make()->Stop(); }

}  // namespace
}  // namespace uplink::store
