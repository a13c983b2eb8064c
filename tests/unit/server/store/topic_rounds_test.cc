#include "server/store/topic_rounds.h"

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/eventually.h"
#include "tests/support/fake_leases.h"
#include "tests/support/fake_reader.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::store {
namespace {

constexpr storage::ProcessId kSelf{1};
constexpr storage::ProcessId kOther{2};
constexpr std::uint32_t kUnackedMax = 10;

/// This process wants topics that another one has.
class TopicRoundsTest : public ::testing::Test {
 protected:
  TopicRoundsTest() {
    testing::FakeTopicLeases other(database_, kOther);
    const auto epoch = other.Take(
        {.client_id = "us", .prefixes = {""}, .at = clock_.System(), .unacked_max = kUnackedMax});
    EXPECT_TRUE(epoch.ok() && epoch->has_value());
    auto leases = std::make_unique<testing::FakeTopicLeases>(database_, kSelf);
    leases_ = leases.get();
    rounds_ = std::make_unique<TopicRounds>(
        std::move(leases),
        TopicRounds::Context{
            .clock = clock_,
            .logger = logger_,
            .reader = reader_,
            .process = kSelf,
            .client_id = "us",
            .prefixes = {""},
            .judge =
                [this](const storage::ProcessId& process) {
                  EXPECT_EQ(process, kOther);
                  ++asked_;
                  return judge_();
                },
            .taken = [this](const broker::Grant& /*grant*/) { taken_ = true; },
            .lost = [this] { ++lost_; },
            .reread = [this](const broker::Remembered& /*remembered*/) { ++reread_; },
            .reconnected = [this] { ++reconnected_; }});
  }

  using Verdict = std::optional<LeaseJudge::Verdict>;

  testing::ManualClock clock_;
  testing::FakeDatabase database_;
  testing::FakeReader reader_{database_};
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  std::function<Verdict()> judge_;
  std::atomic<int> asked_{0};
  std::atomic<bool> taken_{false};
  int lost_ = 0;
  int reread_ = 0;
  int reconnected_ = 0;
  testing::FakeTopicLeases* leases_ = nullptr;
  std::unique_ptr<TopicRounds> rounds_;
};

TEST_F(TopicRoundsTest, TakesTheTopicsOfAProcessThatIsOver) {
  judge_ = [] { return Verdict(LeaseJudge::Verdict{.over = Over::kNo, .name = "b:2"}); };
  rounds_->Look();
  EXPECT_FALSE(taken_);
  EXPECT_EQ(rounds_->held_by(), "b:2");
  judge_ = [] { return Verdict(LeaseJudge::Verdict{.over = Over::kGone}); };
  rounds_->Look();
  EXPECT_TRUE(taken_);
  EXPECT_EQ(rounds_->held_by(), "");
}

TEST_F(TopicRoundsTest, LooksAgainSoonWhileTheHolderIsNotJudgedYet) {
  // So many looks at their usual distance would take longer than the test has.
  constexpr auto looks = 2 * testing::kPatience / milliseconds(kTopicLookEvery);
  judge_ = [this] {
    return asked_ > looks ? Verdict(LeaseJudge::Verdict{.over = Over::kGone}) : std::nullopt;
  };
  rounds_->Start();
  EXPECT_TRUE(testing::Eventually([this] { return taken_.load(); }));
  rounds_->Stop();
}

TEST_F(TopicRoundsTest, TellsOnceThatAnotherTookThem) {
  judge_ = [] { return Verdict(LeaseJudge::Verdict{.over = Over::kGone}); };
  rounds_->Look();
  rounds_->Look();
  EXPECT_EQ(lost_, 0);
  testing::FakeTopicLeases other(database_, kOther);
  ASSERT_TRUE((*other.Take({.client_id = "us",
                            .prefixes = {""},
                            .over = {{.process = kSelf, .lease_counter = 0}},
                            .at = clock_.System(),
                            .unacked_max = kUnackedMax}))
                  .has_value());
  judge_ = [] { return Verdict(LeaseJudge::Verdict{.over = Over::kNo, .name = "b:2"}); };
  rounds_->Look();
  rounds_->Look();
  EXPECT_EQ(lost_, 1);
  EXPECT_EQ(rounds_->held_by(), "b:2");
}

TEST_F(TopicRoundsTest, ReadsTheMemoryAgainWhenItIsAskedFor) {
  judge_ = [] { return Verdict(LeaseJudge::Verdict{.over = Over::kGone}); };
  rounds_->Look();
  rounds_->Look();
  EXPECT_EQ(reread_, 0);
  rounds_->RereadSoon(1);
  leases_->SetAway(true);
  rounds_->Look();
  EXPECT_EQ(reread_, 0);
  leases_->SetAway(false);
  rounds_->Look();
  rounds_->Look();
  EXPECT_EQ(reread_, 1);
}

TEST_F(TopicRoundsTest, SaysThatTheStoreWasConnectedToAnewBeforeAConnectionMayBeMade) {
  judge_ = [] { return Verdict(LeaseJudge::Verdict{.over = Over::kGone}); };
  rounds_->Look();
  rounds_->Look();
  EXPECT_EQ(reconnected_, 0) << "what a lease begins with is read as it begins";
  leases_->Reconnect();
  clock_.Advance(milliseconds(1));
  const SteadyTime now = clock_.Steady();
  EXPECT_FALSE(rounds_->MayConnect(now));
  rounds_->Look();
  EXPECT_EQ(reconnected_, 1);
  EXPECT_TRUE(rounds_->MayConnect(now));
  rounds_->Look();
  EXPECT_EQ(reconnected_, 1);
}

TEST_F(TopicRoundsTest, AConnectionMayBeMadeAfterALookThatFoundTheLeaseOurs) {
  judge_ = [] { return Verdict(LeaseJudge::Verdict{.over = Over::kGone}); };
  EXPECT_FALSE(rounds_->MayConnect(SteadyTime()));
  rounds_->Look();
  EXPECT_TRUE(rounds_->MayConnect(clock_.Steady()));
  clock_.Advance(std::chrono::seconds(1));
  const SteadyTime ended = clock_.Steady();
  EXPECT_FALSE(rounds_->MayConnect(ended)) << "no look since";
  rounds_->Look();
  EXPECT_TRUE(rounds_->MayConnect(ended));
}

TEST_F(TopicRoundsTest, WhileTheStoreIsAwayOursStaysOursForAMoment) {
  judge_ = [] { return Verdict(LeaseJudge::Verdict{.over = Over::kGone}); };
  rounds_->Look();
  clock_.Advance(std::chrono::seconds(1));
  const SteadyTime ended = clock_.Steady();
  leases_->SetAway(true);
  rounds_->Look();
  EXPECT_TRUE(rounds_->failing());
  EXPECT_TRUE(rounds_->MayConnect(ended));
  clock_.Advance(kLeaseTrusted);
  EXPECT_FALSE(rounds_->MayConnect(ended)) << "another may have found us silent";
  EXPECT_EQ(lost_, 0) << "a store that cannot be asked takes nothing away";
  leases_->SetAway(false);
  rounds_->Look();
  EXPECT_FALSE(rounds_->failing());
  EXPECT_TRUE(rounds_->MayConnect(ended));
}

}  // namespace
}  // namespace uplink::store
