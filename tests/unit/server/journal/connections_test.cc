#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/journal/connection_notes.h"
#include "tests/unit/server/journal/journal_bench.h"

/// How the journal writes connections of robots, and ends those of servers that are over.
namespace uplink::journal {
namespace {

using model::ConnectionEnd;
using ::testing::ElementsAre;
using testing::FailAt;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr storage::ProcessId kSelf = {1};
constexpr storage::ProcessId kOther = {2};

class JournalConnections : public ::testing::Test, protected JournalBench {
 protected:
  using JournalBench::Run;

  JournalConnections() : JournalBench({.connections_max = 4}) {
    Open(client_);
    Run();
  }
  storage::ConnectionItem Item(std::uint8_t id, const storage::ProcessId& process = kSelf) {
    storage::ConnectionItem item;
    item.robot = client_.robot();
    item.id = {id};
    item.began_at = clock.System();
    item.process = process;
    return item;
  }
  storage::ConnectionItem Ended(std::uint8_t id) {
    storage::ConnectionItem item = Item(id);
    item.ended = {.at = clock.System(), .why = ConnectionEnd::kBroken, .code = {}, .detail = {}};
    return item;
  }
  /// By their ids, newest first.
  std::vector<int> Ids(bool open = false) {
    std::vector<int> ids;
    const auto page = store.Connections({.rows = {}, .open = open});
    for (const auto& row : page->rows) {
      ids.push_back(row.id[0]);
    }
    return ids;
  }

  RecordingClient client_{"rcan://a"};
};

TEST_F(JournalConnections, AreCommittedByThemselves) {
  journal.NoteConnection(Item(1));
  EXPECT_FALSE(journal.idle()) << "drain waits for it";
  EXPECT_EQ(journal.records(), 0U) << "it holds no stream back";
  Run();
  EXPECT_TRUE(journal.idle());
  EXPECT_THAT(Ids(true), ElementsAre(1));
  journal.NoteConnection(Ended(1));
  Run();
  EXPECT_THAT(Ids(), ElementsAre(1));
  EXPECT_THAT(Ids(true), IsEmpty());
  EXPECT_EQ(probe.connections_written.value(), 2);
}

TEST_F(JournalConnections, AreNotedByWhatReportsThem) {
  const Shards shards({&journal});
  ConnectionNotes notes(shards);
  notes.Begin(Item(1));
  Run();
  EXPECT_THAT(Ids(true), ElementsAre(1));
  storage::ConnectionItem more = Item(1);
  more.messages = 5;
  notes.Update(more);
  Run();
  EXPECT_EQ(store.Connections({})->rows.at(0).messages, 5U);
  EXPECT_THAT(Ids(true), ElementsAre(1));
  notes.End(Ended(1));
  Run();
  EXPECT_THAT(Ids(true), IsEmpty());
  EXPECT_THAT(Ids(), ElementsAre(1));
}

TEST_F(JournalConnections, SurviveAStoreThatIsAway) {
  store.FailNextCommits(2, FailAt::kBefore);
  journal.NoteConnection(Item(1));
  EXPECT_EQ(journal.turns().Advance(), Step::kFailed);
  journal.NoteConnection(Ended(1));
  journal.NoteConnection(Item(2));
  EXPECT_EQ(journal.turns().Advance(), Step::kFailed);
  Run();
  EXPECT_TRUE(journal.idle());
  EXPECT_THAT(Ids(), ElementsAre(2, 1));
  EXPECT_THAT(Ids(true), ElementsAre(2));
}

TEST_F(JournalConnections, PastTheirBoundAreDroppedAndTold) {
  std::vector<std::string> dropped;
  journal.OnConnectionDropped(
      [&dropped](const model::RobotId& robot) { dropped.push_back(robot.ruri); });
  for (std::uint8_t id = 1; id <= 6; ++id) journal.NoteConnection(Item(id));
  EXPECT_EQ(probe.connections_dropped.value(), 2);
  EXPECT_THAT(dropped, ElementsAre("rcan://a", "rcan://a"));
  Run();
  EXPECT_THAT(Ids(), SizeIs(4));
  journal.NoteConnection(Ended(6));
  Run();
  EXPECT_THAT(Ids(), SizeIs(5)) << "its end tells all of it";
}

TEST_F(JournalConnections, OfOneGatewayLeaveHalfOfTheRoomToOthers) {
  for (std::uint8_t id = 1; id <= 3; ++id) {
    storage::ConnectionItem item = Item(id);
    item.gateway = "CN=site";
    journal.NoteConnection(item);
  }
  EXPECT_EQ(probe.connections_dropped.value(), 1) << "two of four are its share";
  journal.NoteConnection(Item(4));
  Run();
  EXPECT_THAT(Ids(), ElementsAre(4, 2, 1));
  storage::ConnectionItem again = Item(5);
  again.gateway = "CN=site";
  journal.NoteConnection(again);
  EXPECT_EQ(probe.connections_dropped.value(), 1) << "what is written takes no share";
}

TEST_F(JournalConnections, OfARobotByItselfTakeWhatRoomThereIs) {
  for (std::uint8_t id = 1; id <= 4; ++id) journal.NoteConnection(Item(id));
  EXPECT_EQ(probe.connections_dropped.value(), 0) << "its newest one must not be missing";
}

TEST_F(JournalConnections, OfANewRobotWaitForItsRow) {
  RecordingClient other("rcan://b");
  Open(other);
  storage::ConnectionItem item = Item(7);
  item.robot = other.robot();
  journal.NoteConnection(item);
  Run();
  EXPECT_THAT(Ids(), ElementsAre(7));
}

TEST_F(JournalConnections, DoNotWaitForRowsOnceTheyWouldBeLost) {
  store.FailNextOpens(1'000, FailAt::kBefore);
  RecordingClient other("rcan://b");
  Open(other);
  journal.NoteConnection(Item(1));
  for (int i = 0; i < 4; ++i) static_cast<void>(journal.turns().Advance());
  EXPECT_THAT(Ids(), IsEmpty()) << "a stream waits for the store";
  journal.NoteConnection(Item(2));
  for (int i = 0; i < 8; ++i) static_cast<void>(journal.turns().Advance());
  EXPECT_THAT(Ids(), ElementsAre(2, 1)) << "half of the bound";
}

TEST_F(JournalConnections, TakePresenceWithItsReason) {
  journal.NotePresence(client_.robot(), model::Presence::kOnline, clock.System());
  Run();
  journal.NotePresence(client_.robot(), model::Presence::kOffline, clock.System(),
                       ConnectionEnd::kSilent);
  Run();
  const auto rows = store.PresenceChanges({})->rows;
  ASSERT_THAT(rows, SizeIs(2));
  EXPECT_EQ(rows[0].why, ConnectionEnd::kSilent);
  EXPECT_EQ(rows[1].why, std::nullopt);
}

class JournalConnectionEnds : public JournalConnections {
 protected:
  /// The other process's connection is open, and it is `over_`.
  JournalConnectionEnds() {
    storage::Batch batch;
    batch.connections = {Item(1), Item(2, kOther)};
    EXPECT_TRUE(store.Commit(batch).ok());
    journal.EndConnections([this](const storage::ProcessId& process) {
      EXPECT_EQ(process, kOther);
      return over_;
    });
  }
  std::optional<bool> over_;
};

TEST_F(JournalConnectionEnds, EndWhatAServerLeftOpenOnceItIsOver) {
  Run();
  EXPECT_THAT(Ids(true), ElementsAre(2, 1)) << "in question";
  over_ = true;
  clock.Advance(kEndsAgain - milliseconds(1));
  Run();
  EXPECT_THAT(Ids(true), ElementsAre(2, 1)) << "not due";
  clock.Advance(milliseconds(1));
  Run();
  EXPECT_THAT(Ids(true), ElementsAre(1));
  EXPECT_EQ(probe.connections_ended.value(), 1);
}

TEST_F(JournalConnectionEnds, LeaveThoseOfAServerThatLives) {
  over_ = false;
  Run();
  clock.Advance(kEndsAgain);
  over_ = true;
  Run();
  EXPECT_THAT(Ids(true), ElementsAre(2, 1)) << "looked at as often as expired items";
  clock.Advance(kSweepInterval);
  Run();
  EXPECT_THAT(Ids(true), ElementsAre(1));
}

TEST_F(JournalConnectionEnds, TryAgainAfterTheStoreFailed) {
  over_ = true;
  store.FailNextSweeps(1, FailAt::kBefore);
  Run();
  EXPECT_FALSE(journal.last_error().ok());
  clock.Advance(kSweepInterval);
  Run();
  Run();
  EXPECT_THAT(Ids(true), ElementsAre(1));
}

}  // namespace
}  // namespace uplink::journal
