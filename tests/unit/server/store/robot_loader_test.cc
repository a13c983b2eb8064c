#include "server/store/robot_loader.h"

#include <gtest/gtest.h>

#include "server/journal/turns.h"
#include "tests/support/fake_store.h"
#include "tests/support/manual_clock.h"
#include "tests/support/records.h"
#include "tests/support/switched_reader.h"
#include "tests/unit/server/store/known_robot.h"

namespace uplink::store {
namespace {

class RobotLoaderTest : public ::testing::Test {
 protected:
  robot::StateSnapshot State(const std::string& ruri) {
    return fleet_.Find(ruri)->state.Snapshot(robot::RobotState::Parts::kAll);
  }

  testing::ManualClock clock_;
  testing::FakeDatabase database_;
  testing::FakeStore store_{database_, storage::ProcessId{9}};
  testing::FakeStore ours_{database_, storage::ProcessId{1}};
  testing::SwitchedReader reader_{store_};
  metrics::Ledger ledger_;
  journal::JournalProbe probe_;
  fleet::Fleet fleet_{clock_, 2, {}};
  journal::Journal journal_{ours_, {}, clock_, ledger_, probe_, storage::ProcessId{1}};
  journal::Shards journals_{{&journal_}};
  RobotLoader loader_{{fleet_, journals_, reader_, std::nullopt}};
};

TEST_F(RobotLoaderTest, TakesTheRobotsOfTheStore) {
  Know(store_, "rcan://a", clock_.System());
  EXPECT_FALSE(loader_.done());
  EXPECT_TRUE(loader_.Run(2).ok());
  EXPECT_TRUE(loader_.done());
  EXPECT_EQ(fleet_.size(), 1U);
}

TEST_F(RobotLoaderTest, CanBeRunAgainWhileTheStoreIsAway) {
  Know(store_, "rcan://a", clock_.System());
  reader_.SetAway(true);
  EXPECT_FALSE(loader_.Run(2).ok());
  EXPECT_FALSE(loader_.done());
  EXPECT_EQ(fleet_.size(), 0U);
  reader_.SetAway(false);
  EXPECT_TRUE(loader_.Run(2).ok());
  EXPECT_EQ(fleet_.size(), 1U);
}

TEST_F(RobotLoaderTest, WhoIsForgottenIsLeftInTheStoreUnlessTheStoreCallsItOnline) {
  Know(store_, "rcan://a", clock_.System());
  Know(store_, "rcan://b", clock_.System());
  storage::Batch batch;
  batch.presence_session = model::SessionId({8});
  batch.presence = {{std::make_shared<const model::RobotId>(model::RobotId{"rcan://b", "f"}),
                     model::Presence::kOnline, clock_.System(), 1,
                     database_.HeldSinceOf("rcan://b")}};
  ASSERT_TRUE(store_.Commit(batch).ok());
  RobotLoader loader({fleet_, journals_, reader_, std::nullopt, [](SystemTime) { return true; }});
  const auto left_out = loader.Run(2);
  ASSERT_TRUE(left_out.ok());
  EXPECT_EQ(*left_out, 0U) << "there was room";
  EXPECT_EQ(fleet_.Find("rcan://a"), nullptr);
  EXPECT_NE(fleet_.Find("rcan://b"), nullptr) << "it must be judged first";
}

TEST_F(RobotLoaderTest, TellsWhichOddFleetsTheStoreHasAlsoOfRobotsThatAreForgotten) {
  using Verdict = fleet::OddFleets::Verdict;
  const std::string odd = "no\xE2\x80\x8Brth";  // U+200B
  Know(store_, "rcan://a", clock_.System(), odd);
  RobotLoader loader({fleet_, journals_, reader_, std::nullopt, [](SystemTime) { return true; }});
  EXPECT_EQ(fleet_.odd_fleets().Judge(odd), Verdict::kUnread);
  ASSERT_TRUE(loader.Run(2).ok());
  EXPECT_EQ(fleet_.size(), 0U);
  EXPECT_EQ(fleet_.odd_fleets().Judge(odd), Verdict::kFits);
  EXPECT_EQ(fleet_.odd_fleets().Judge(odd + "2"), Verdict::kRefused);
}

TEST_F(RobotLoaderTest, TellsWhichOddFleetsTheStoreHasAlsoOfRobotsThatThereIsNoRoomFor) {
  using Verdict = fleet::OddFleets::Verdict;
  const std::string odd = "no\xE2\x80\x8Brth";  // U+200B
  Know(store_, "rcan://old", clock_.System(), odd);
  clock_.Advance(std::chrono::hours(1));
  Know(store_, "rcan://a", clock_.System());
  Know(store_, "rcan://b", clock_.System());
  const auto left_out = loader_.Run(2);
  ASSERT_TRUE(left_out.ok());
  EXPECT_EQ(*left_out, 1U);
  EXPECT_EQ(fleet_.Find("rcan://old"), nullptr);
  EXPECT_EQ(fleet_.odd_fleets().Judge(odd), Verdict::kFits);
  EXPECT_EQ(fleet_.odd_fleets().Judge(odd + "2"), Verdict::kRefused);
}

TEST_F(RobotLoaderTest, ARobotThatHasComeByItselfStaysAsItIs) {
  Know(store_, "rcan://a", clock_.System());
  ASSERT_TRUE(fleet_.FindOrAdmit({"rcan://a", "another"}).ok());
  EXPECT_TRUE(loader_.Run(2).ok());
  EXPECT_EQ(fleet_.Find("rcan://a")->id()->fleet, "another");
}

TEST_F(RobotLoaderTest, RobotsComeWithTheirLastSession) {
  Know(store_, "rcan://a", clock_.System());
  storage::Batch batch;
  batch.records.push_back(
      {.robot = std::make_shared<const model::RobotId>(model::RobotId{"rcan://a", "f"}),
       .session = model::SessionId({1}),
       .seq = 12,
       .held_since = 1,
       .received_at = clock_.System(),
       .content = test::RecordOf(model::AgentInfo{})});
  ASSERT_TRUE(store_.Commit(batch).ok());
  ASSERT_TRUE(loader_.Run(2).ok());
  const robot::SessionView view = fleet_.Find("rcan://a")->sessions.View();
  EXPECT_EQ(view.session, model::SessionId({1}));
  EXPECT_EQ(view.settled_seq, 12U);
  EXPECT_FALSE(view.connected);
}

TEST_F(RobotLoaderTest, ARobotThatHasComeByItselfKeepsItsSession) {
  Know(store_, "rcan://a", clock_.System());
  const auto robot = fleet_.FindOrAdmit({"rcan://a", "f"});
  ASSERT_TRUE(robot.ok());
  ASSERT_TRUE((*robot)->sessions.Begin(model::SessionId({9}), clock_.Steady()));
  ASSERT_TRUE(loader_.Run(2).ok());
  EXPECT_EQ((*robot)->sessions.View().session, model::SessionId({9}));
}

TEST_F(RobotLoaderTest, ShowsARobotAsItsLastHolderWroteIt) {
  Know(store_, "rcan://a", clock_.System());
  Know(store_, "rcan://b", clock_.System());
  storage::Batch batch;
  batch.presence = {{std::make_shared<const model::RobotId>(model::RobotId{"rcan://a", "f"}),
                     model::Presence::kOnline, FromUnixMs(7), 1, 1}};
  ASSERT_TRUE(store_.Commit(batch).ok());
  const SystemTime known_since = clock_.System();
  clock_.Advance(std::chrono::hours(1));
  ASSERT_TRUE(loader_.Run(2).ok());
  EXPECT_EQ(State("rcan://a").presence, robot::Presence::kOnline);
  EXPECT_EQ(State("rcan://a").presence_since, FromUnixMs(7));
  EXPECT_TRUE(State("rcan://a").foreign.has_value());
  EXPECT_EQ(State("rcan://b").presence, robot::Presence::kUnknown);
  EXPECT_EQ(State("rcan://b").presence_since, known_since);
  static_cast<void>(journal_.turns().Advance());
  EXPECT_TRUE(State("rcan://a").foreign.has_value()) << "its holder may live";
}

TEST_F(RobotLoaderTest, AdoptsWhatNobodyElseCanHold) {
  Know(store_, "rcan://a", clock_.System());
  RobotLoader loader({fleet_, journals_, reader_, std::chrono::minutes(2)});
  ASSERT_TRUE(loader.Run(2).ok());
  EXPECT_EQ(journal_.turns().Advance(), journal::Step::kWorked);
  EXPECT_FALSE(State("rcan://a").foreign.has_value());
  EXPECT_EQ(fleet_.Find("rcan://a")->state.held_since(), 2U);
  EXPECT_TRUE(fleet_.Find("rcan://a")->state.needs_restore());
}

/// As a start finds a store that it has alone: what was known stands.
TEST_F(RobotLoaderTest, WhoWasOfflineStaysSoWithItsTimeAndWithoutARow) {
  Know(store_, "rcan://a", clock_.System());
  Know(store_, "rcan://b", clock_.System());
  const auto change = [this](const std::string& ruri, model::Presence presence, model::Seq number) {
    return storage::PresenceItem{std::make_shared<const model::RobotId>(model::RobotId{ruri, "f"}),
                                 presence, FromUnixMs(7), number, database_.HeldSinceOf(ruri)};
  };
  storage::Batch batch;
  batch.presence_session = model::SessionId({8});
  batch.presence = {change("rcan://a", model::Presence::kOffline, 1),
                    change("rcan://b", model::Presence::kOnline, 2)};
  ASSERT_TRUE(store_.Commit(batch).ok());
  fleet_.OnPresence(
      [this](const storage::RobotRef& robot, const storage::StoredPresence& now, auto why) {
        journals_.NotePresence(robot, now.presence, now.since, why, now.parked_until);
      });
  const auto all = [this] {
    while (journal_.turns().Advance() == journal::Step::kWorked) {
    }
    clock_.Advance(std::chrono::seconds(1));
    fleet_.Sweep(std::chrono::hours(1));
  };
  RobotLoader loader({fleet_, journals_, reader_, std::chrono::minutes(2)});
  ASSERT_TRUE(loader.Run(2).ok());
  for (int i = 0; i < 10; ++i) all();
  EXPECT_FALSE(State("rcan://a").foreign.has_value());
  EXPECT_EQ(State("rcan://a").presence, robot::Presence::kOffline);
  EXPECT_EQ(State("rcan://a").presence_since, FromUnixMs(7));
  EXPECT_EQ(State("rcan://b").presence, robot::Presence::kUnknown) << "it was online";
  EXPECT_EQ(fleet_.presence_counts().offline, 1);
  EXPECT_EQ(ours_.PresenceChanges({})->rows.size(), 3U) << "nothing is written of the first";
  fleet_.Find("rcan://a")->state.SignOfLife(clock_.Steady(), clock_.System(), {});
  all();
  EXPECT_EQ(State("rcan://a").presence, robot::Presence::kOnline);
  EXPECT_EQ(ours_.PresenceChanges({})->rows.size(), 4U);
}

TEST_F(RobotLoaderTest, TellsHowManyRobotsItLeftOut) {
  for (const char* ruri : {"rcan://a", "rcan://b"}) Know(store_, ruri, clock_.System());
  ASSERT_TRUE(fleet_.FindOrAdmit({"rcan://c", "f"}).ok());
  const auto left_out = loader_.Run(2);
  ASSERT_TRUE(left_out.ok());
  EXPECT_EQ(*left_out, 1U);
  EXPECT_TRUE(loader_.done()) << "trying again would change nothing";
}

}  // namespace
}  // namespace uplink::store
