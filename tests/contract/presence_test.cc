#include <vector>

#include <gmock/gmock.h>

#include "storage/bounds.h"
#include "tests/contract/store_contract.h"

/// Presence changes: records that the server makes itself, numbered by its own sessions.
namespace uplink::testing {
namespace {

using model::Presence;
using storage::OutcomeKind;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class PresenceContract : public StoreContract {
 protected:
  storage::PresenceItem Change(model::Seq number, Presence presence, std::int64_t at_ms = 0) const {
    return {robot_, presence, Time(at_ms), number, held_since_};
  }
  static model::SessionId ProcessSession(std::uint16_t number) {
    return model::SessionId(
        {0xEE, static_cast<std::uint8_t>(number >> 8), static_cast<std::uint8_t>(number & 0xFF)});
  }
  static storage::Batch Changes(std::vector<storage::PresenceItem> items,
                                std::uint16_t session = 1) {
    storage::Batch batch;
    batch.presence = std::move(items);
    batch.presence_session = ProcessSession(session);
    return batch;
  }
  std::vector<Presence> Listed() {
    std::vector<Presence> listed;
    for (const auto& row : StoreContract::Changes()) listed.push_back(row.presence);
    return listed;
  }
  std::vector<storage::RobotRow> Robots() {
    auto robots = store_->reader().Robots(100);
    EXPECT_TRUE(robots.ok()) << robots.status();
    return robots.ok() ? *std::move(robots) : std::vector<storage::RobotRow>();
  }
};

TEST_P(PresenceContract, ReadsChangesBack) {
  Open();
  Commit(Changes({Change(1, Presence::kOnline, 5), Change(2, Presence::kOffline, 9),
                  Change(3, Presence::kUnknown, 12)}));
  const auto rows = StoreContract::Changes();
  ASSERT_THAT(rows, SizeIs(3));
  EXPECT_EQ(rows[0].presence, Presence::kUnknown);
  EXPECT_EQ(rows[1].presence, Presence::kOffline);
  EXPECT_EQ(rows[2].presence, Presence::kOnline);
  EXPECT_EQ(rows[2].robot, *robot_);
  EXPECT_EQ(rows[2].at, Time(5));
}

TEST_P(PresenceContract, WritesANumberOnce) {
  Open();
  const storage::Batch batch =
      Changes({Change(1, Presence::kOnline), Change(2, Presence::kOffline, 1)});
  store_->LoseNextAnswer(kProcess);
  EXPECT_FALSE(store_->Process(kProcess).Commit(batch).ok());
  Commit(batch);
  EXPECT_THAT(Listed(), ElementsAre(Presence::kOffline, Presence::kOnline));
  // A number that the batch before had not, after two that it had.
  storage::Batch more = batch;
  more.presence.push_back(Change(3, Presence::kOnline, 2));
  Commit(more);
  EXPECT_THAT(Listed(), ElementsAre(Presence::kOnline, Presence::kOffline, Presence::kOnline));
  Commit(Changes({Change(4, Presence::kOffline, 3), Change(4, Presence::kOnline, 3)}));
  EXPECT_THAT(Listed(), SizeIs(4)) << "a number twice in a batch";
  Commit(Changes({Change(0, Presence::kOnline, 4)}, 9));
  EXPECT_THAT(Listed(), SizeIs(4)) << "numbers begin at 1";
}

TEST_P(PresenceContract, KeepsNothingOfACommitThatFails) {
  Open();
  storage::Batch batch = Changes({Change(1, Presence::kOnline)});
  batch.records = {Good(1)};
  store_->FailNextWrite(kProcess);
  EXPECT_FALSE(store_->Process(kProcess).Commit(batch).ok());
  EXPECT_THAT(Listed(), IsEmpty());
  Commit(batch);
  EXPECT_THAT(Listed(), SizeIs(1));
}

TEST_P(PresenceContract, NumbersEachSessionOfAProcessApart) {
  Open();
  Commit(Changes({Change(1, Presence::kOnline)}, 1));
  Commit(Changes({Change(1, Presence::kOffline, 1)}, 2));
  Commit(Changes({Change(1, Presence::kUnknown, 2)}, 1));
  EXPECT_THAT(Listed(), ElementsAre(Presence::kOffline, Presence::kOnline));
}

TEST_P(PresenceContract, StandsApartFromARobotsSessionOfTheSameBytes) {
  Open();
  storage::Batch batch;
  batch.presence_session = session_;
  batch.presence = {Change(7, Presence::kOnline)};
  Commit(batch);
  EXPECT_EQ(CursorNow(), 0);
  EXPECT_THAT(Commit({Good(1)}), ElementsAre(OutcomeKind::kStored));
}

TEST_P(PresenceContract, IsRefusedOfARobotThatAnotherProcessHolds) {
  Open();
  const storage::Epoch old_hold = held_since_;
  const storage::RobotRef other = Robot("b");
  storage::OpenRequest request = Request();
  request.robot = other;
  const storage::Epoch hold_of_other = Open(request).held_since;
  Open(Request(), kOther);
  const storage::Epoch new_hold = held_since_;
  held_since_ = old_hold;
  storage::Batch batch = Changes({Change(1, Presence::kOffline), Change(2, Presence::kOnline)});
  batch.presence[1].robot = other;
  batch.presence[1].held_since = hold_of_other;
  batch.records = {Good(1)};
  const auto outcomes = Commit(batch);
  ASSERT_THAT(outcomes, SizeIs(3)) << "one per record, then one per change";
  EXPECT_EQ(outcomes[0].kind, OutcomeKind::kFenced);
  EXPECT_EQ(outcomes[1].kind, OutcomeKind::kFenced);
  EXPECT_EQ(outcomes[2].kind, OutcomeKind::kStored) << "the rest of the batch goes on";
  EXPECT_THAT(Listed(), ElementsAre(Presence::kOnline));
  EXPECT_EQ(Commit(batch).at(2).kind, OutcomeKind::kDuplicate);

  held_since_ = new_hold;
  EXPECT_EQ(Commit(Changes({Change(1, Presence::kOffline, 1)}, 2), kOther).at(0).kind,
            OutcomeKind::kStored);
  EXPECT_THAT(Listed(), ElementsAre(Presence::kOffline, Presence::kOnline));
}

TEST_P(PresenceContract, IsRefusedAloneInABatch) {
  Open();
  const storage::Epoch old_hold = held_since_;
  Open(Request(), kOther);
  held_since_ = old_hold;
  EXPECT_EQ(Commit(Changes({Change(1, Presence::kOffline)})).at(0).kind, OutcomeKind::kFenced);
  EXPECT_THAT(Listed(), IsEmpty());
}

TEST_P(PresenceContract, ShowsInTheListOfRobotsAsTheLastPresenceAlone) {
  Open();
  storage::OpenRequest request = Request();
  request.robot = Robot("b");
  Open(request);
  Open();
  EXPECT_EQ(Robots().at(0).last_presence, std::nullopt);
  Commit(Changes({Change(1, Presence::kOffline, 50), Change(2, Presence::kOnline, 60)}));
  const auto robots = Robots();
  ASSERT_THAT(robots, SizeIs(2)) << "the server is no robot";
  EXPECT_EQ(robots[0].robot, *robot_);
  EXPECT_EQ(robots[0].last_presence, Presence::kOnline);
  EXPECT_EQ(robots[0].presence_since, Time(60));
  EXPECT_EQ(robots[0].last_seen, Time()) << "the change was none of the robot's doing";
  EXPECT_EQ(robots[1].last_presence, std::nullopt);
  Commit(Changes({Change(1, Presence::kUnknown, 70)}, 2));
  EXPECT_EQ(Robots().at(0).last_presence, Presence::kUnknown);
  store_->Reopen();
  EXPECT_EQ(Robots().at(0).last_presence, Presence::kUnknown);
  EXPECT_EQ(Robots().at(0).presence_since, Time(70));
}

TEST_P(PresenceContract, KeepsUntilWhenARobotIsParked) {
  Open();
  Commit(Changes({Change(1, Presence::kOnline, 5)}));
  EXPECT_EQ(Robots().at(0).parked_until, std::nullopt);
  storage::PresenceItem parked = Change(2, Presence::kOnline, 5);
  parked.parked_until = Time(7'200'000);
  parked.changes_presence = false;
  Commit(Changes({parked}));
  EXPECT_THAT(Listed(), ElementsAre(Presence::kOnline)) << "no presence changed";
  store_->Reopen();
  EXPECT_EQ(Robots().at(0).parked_until, Time(7'200'000));
  EXPECT_EQ(Robots().at(0).presence_since, Time(5));

  storage::PresenceItem offline = Change(3, Presence::kOffline, 15);
  offline.parked_until = Time(7'200'000);
  Commit(Changes({offline}));
  EXPECT_THAT(Listed(), ElementsAre(Presence::kOffline, Presence::kOnline));
  const auto opened = Open(Request(), kOther);
  ASSERT_TRUE(opened.presence.has_value());
  EXPECT_EQ(*opened.presence,
            (storage::StoredPresence{Presence::kOffline, Time(15), Time(7'200'000)}));
  Commit(Changes({Change(1, Presence::kOnline, 20)}, 2), kOther);
  EXPECT_EQ(Robots().at(0).parked_until, std::nullopt) << "it is back";
}

TEST_P(PresenceContract, IsRefusedOfARobotThatHasNoRow) {
  held_since_ = 40;
  EXPECT_EQ(Commit(Changes({Change(1, Presence::kOnline)})).at(0).kind, OutcomeKind::kFenced);
  Open();
  EXPECT_EQ(Commit(Changes({Change(2, Presence::kOnline)})).at(0).kind, OutcomeKind::kStored);
  store_->DeleteRobotRow(robot_->ruri);
  EXPECT_EQ(Commit(Changes({Change(3, Presence::kOffline)})).at(0).kind, OutcomeKind::kFenced);
  EXPECT_THAT(Listed(), ElementsAre(Presence::kOnline));
  EXPECT_THAT(Robots(), IsEmpty());
  const storage::OpenResult opened = Open();
  ASSERT_TRUE(opened.presence.has_value()) << "what was kept of it before";
  EXPECT_EQ(opened.presence->presence, Presence::kOnline);
}

TEST_P(PresenceContract, TakesNoneOfARobotsSessions) {
  storage::OpenRequest request = Request();
  for (std::uint8_t i = 1; i <= storage::kSessionsPerRobotMax; ++i) {
    request.session = Session(i);
    request.at = Time(i);
    Open(request);
    storage::CommitRecord record = At(i, Good(5));
    record.session = request.session;
    Commit({record});
  }
  for (std::uint16_t i = 1; i <= 20; ++i) Commit(Changes({Change(1, Presence::kOnline, i)}, i));
  for (std::uint8_t i = 1; i <= storage::kSessionsPerRobotMax; ++i) {
    request.session = Session(i);
    EXPECT_EQ(Open(request).cursor, 5) << int{i};
  }
  for (std::uint16_t i = 1; i <= 20; ++i) Commit(Changes({Change(1, Presence::kOnline, i)}, i));
  EXPECT_THAT(Listed(), SizeIs(20)) << "and robots' streams take none of the server's";
}

TEST_P(PresenceContract, ForgetsTheSessionThatWasUsedLeastRecently) {
  Open();
  std::int64_t ms = 0;
  const auto commit = [&](std::uint16_t session, model::Seq number) {
    Commit(Changes({Change(number, Presence::kOnline, ++ms)}, session));
  };
  for (std::uint16_t i = 1; i <= storage::kServerSessionsMax; ++i) commit(i, 1);
  commit(1, 2);
  const auto written = [&] {
    storage::HistoryQuery query;
    query.page_size = storage::kPageSizeMax;
    return StoreContract::Changes(query).size();
  };
  constexpr std::size_t kWritten = storage::kServerSessionsMax + 1;
  EXPECT_EQ(written(), kWritten);
  commit(3, 1);
  EXPECT_EQ(written(), kWritten) << "at the bound all are known";
  commit(3, 2);
  commit(storage::kServerSessionsMax + 1, 1);
  EXPECT_EQ(written(), kWritten + 2);
  commit(1, 2);
  commit(3, 2);
  commit(4, 1);
  EXPECT_EQ(written(), kWritten + 2) << "one alone was forgotten";
  commit(2, 1);
  EXPECT_EQ(written(), kWritten + 3) << "that one";
}

// The server's clock was set back between two changes, in one batch or in two.
TEST_P(PresenceContract, FollowsTheOrderOfCommitsWhateverTheTimesSay) {
  Open();
  Commit(Changes({Change(1, Presence::kOnline, 50), Change(2, Presence::kOffline, 10)}));
  EXPECT_EQ(Robots().at(0).last_presence, Presence::kOffline) << "within a batch";
  EXPECT_EQ(Robots().at(0).presence_since, Time(10));
  Commit(Changes({Change(3, Presence::kUnknown, 5)}));
  EXPECT_EQ(Robots().at(0).last_presence, Presence::kUnknown) << "in a batch of its own";
  EXPECT_EQ(Robots().at(0).presence_since, Time(5));
  const storage::OpenResult opened = Open();
  ASSERT_TRUE(opened.presence.has_value());
  EXPECT_EQ(opened.presence->presence, Presence::kUnknown);
  EXPECT_EQ(opened.presence->since, Time(5));
}

INSTANTIATE_TEST_SUITE_P(Stores, PresenceContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
