#include <deque>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/schema/samples.h"
#include "tests/unit/server/journal/journal_bench.h"

namespace uplink::journal {
namespace {

using model::Presence;
using ::testing::ElementsAre;
using testing::FailAt;
using ::testing::IsEmpty;
using ::testing::SizeIs;

storage::RobotRef RobotOf(const std::string& ruri) {
  return std::make_shared<const model::RobotId>(model::RobotId{ruri, "bench"});
}

std::uint64_t CommitsOf(const JournalProbe& probe) {
  std::uint64_t commits = 0;
  for (std::size_t i = 0; i <= probe.commit_records.upper_bounds().size(); ++i) {
    commits += probe.commit_records.count(i);
  }
  return commits;
}

class JournalPresence : public ::testing::Test, protected JournalBench {
 protected:
  using JournalBench::Run;

  JournalPresence() {
    Open(client_);
    Run();
  }
  void Note(Presence presence) { journal.NotePresence(robot_, presence, clock.System()); }

  /// Newest first.
  std::vector<std::string> Rows() {
    std::vector<std::string> lines;
    const auto page = store.PresenceChanges({});
    for (const storage::PresenceRow& row : page->rows) {
      lines.push_back(row.robot.ruri + " " + std::string(ToText(row.presence)));
    }
    return lines;
  }

  RecordingClient client_{"rcan://a"};
  const storage::RobotRef robot_ = client_.robot();
};

TEST_F(JournalPresence, AChangeIsCommittedByItself) {
  EXPECT_TRUE(journal.idle());
  Note(Presence::kOnline);
  EXPECT_FALSE(journal.idle()) << "drain waits for it";
  EXPECT_EQ(journal.records(), 0U) << "it holds no stream back";
  Run();
  EXPECT_TRUE(journal.idle());
  EXPECT_THAT(Rows(), ElementsAre("rcan://a online"));
  EXPECT_EQ(probe.presence_changes[static_cast<std::size_t>(Presence::kOnline)].value(), 1);
}

TEST_F(JournalPresence, GoesWithTheRecordsOfABatch) {
  Append(client_, 1);
  Note(Presence::kOnline);
  const std::uint64_t before = CommitsOf(probe);
  Run();
  EXPECT_EQ(CommitsOf(probe), before + 1);
  EXPECT_THAT(Stored(client_), ElementsAre(1));
  EXPECT_THAT(Rows(), SizeIs(1));
}

TEST_F(JournalPresence, ALostAnswerDoublesNothing) {
  Note(Presence::kOnline);
  store.FailNextCommits(1, FailAt::kAfter);
  EXPECT_EQ(journal.turns().Advance(), Step::kFailed);
  EXPECT_FALSE(journal.idle());
  Note(Presence::kOffline);
  Run();
  EXPECT_THAT(Rows(), ElementsAre("rcan://a offline", "rcan://a online"));
  EXPECT_TRUE(journal.idle());
}

TEST_F(JournalPresence, WhatFailedIsTriedAgain) {
  Note(Presence::kOnline);
  store.FailNextCommits(2, FailAt::kBefore);
  EXPECT_EQ(journal.turns().Advance(), Step::kFailed);
  EXPECT_EQ(journal.turns().Advance(), Step::kFailed);
  EXPECT_THAT(Rows(), IsEmpty());
  Run();
  EXPECT_THAT(Rows(), ElementsAre("rcan://a online"));
}

TEST_F(JournalPresence, NothingIsWrittenOfARobotThatIsNotHeld) {
  journal.NotePresence(RobotOf("rcan://b"), Presence::kOnline, clock.System());
  Run();
  EXPECT_THAT(Rows(), IsEmpty());
  EXPECT_TRUE(journal.idle());
  RecordingClient b("rcan://b");
  Open(b);
  Run();
  EXPECT_THAT(Rows(), IsEmpty()) << "what a robot is, it says when it is held";
  journal.NotePresence(RobotOf("rcan://b"), Presence::kUnknown, clock.System());
  Run();
  EXPECT_THAT(Rows(), ElementsAre("rcan://b unknown"));
}

TEST_F(JournalPresence, WhatTheStoreRefusesIsCountedAndGoes) {
  testing::FakeStore elsewhere(database, storage::ProcessId{2});
  const storage::OpenRequest request{.robot = robot_, .session = kSession};
  ASSERT_TRUE(elsewhere.OpenStreams({&request, 1}).ok());
  Note(Presence::kOffline);
  Run();
  EXPECT_THAT(Rows(), IsEmpty());
  EXPECT_EQ(probe.presence_refused.value(), 1);
  EXPECT_EQ(probe.presence_changes[static_cast<std::size_t>(Presence::kOffline)].value(), 0);
  EXPECT_TRUE(journal.idle());
}

TEST_F(JournalPresence, ABatchHasAtMostItsChanges) {
  JournalLimits few;
  few.batch_records_max = 2;
  JournalBench bench(few);
  std::deque<RecordingClient> clients;
  for (const char* ruri : {"a", "b", "c"}) bench.Open(clients.emplace_back(ruri));
  bench.Run();
  for (const char* ruri : {"a", "b", "c"}) {
    bench.journal.NotePresence(RobotOf(ruri), Presence::kOnline, clock.System());
  }
  bench.Run();
  EXPECT_EQ(CommitsOf(bench.probe), 2U);
  EXPECT_THAT(bench.store.PresenceChanges({})->rows, SizeIs(3));
}

class JournalSweep : public ::testing::Test, protected JournalBench {
 protected:
  using JournalBench::Run;

  void StoreShapes(std::size_t count) {
    RecordingClient client("rcan://a");
    Open(client);
    Run();
    for (model::Seq seq = 1; seq <= count; ++seq) {
      model::ReportedShape shape = test::SampleShape();
      shape.identity.id = std::to_string(seq);
      shape.expire_time_ms = UnixMs(clock.System()) + 1;
      journal.AppendMessage(client, client.generation(),
                            {{.robot = client.robot(),
                              .session = kSession,
                              .seq = seq,
                              .received_at = clock.System(),
                              .content = test::RecordOf(model::ShapeOp{shape})}},
                            clock.Steady());
    }
    Run();
  }
};

TEST_F(JournalSweep, DeletesWhatExpiredAnHourAgo) {
  StoreShapes(2);
  clock.Advance(storage::kExpiredKept);
  Run();
  EXPECT_EQ(probe.expired_deleted.value(), 0);
  clock.Advance(kSweepInterval - milliseconds(1));
  Run();
  EXPECT_EQ(probe.expired_deleted.value(), 0) << "not before its time";
  clock.Advance(milliseconds(1));
  Run();
  EXPECT_EQ(probe.expired_deleted.value(), 2);
}

TEST_F(JournalSweep, AFailureIsSaidAndWaitsForTheNextTime) {
  StoreShapes(1);
  clock.Advance(storage::kExpiredKept + milliseconds(1));
  store.FailNextSweeps(1, FailAt::kBefore);
  EXPECT_EQ(journal.turns().Advance(), Step::kFailed);
  EXPECT_EQ(probe.store_errors.value(), 1);
  EXPECT_EQ(journal.turns().Advance(), Step::kIdle);
  clock.Advance(kSweepInterval);
  Run();
  EXPECT_EQ(probe.expired_deleted.value(), 1);
}

}  // namespace
}  // namespace uplink::journal
