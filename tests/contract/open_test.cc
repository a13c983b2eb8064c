#include <memory>
#include <set>
#include <vector>

#include <gmock/gmock.h>

#include "storage/bounds.h"
#include "tests/contract/store_contract.h"

namespace uplink::testing {
namespace {

using storage::OpenResult;
using storage::OutcomeKind;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::SizeIs;

std::vector<model::Seq> SeqsOf(const std::vector<storage::StoredReject>& rejects) {
  std::vector<model::Seq> seqs;
  seqs.reserve(rejects.size());
  for (const storage::StoredReject& reject : rejects) seqs.push_back(reject.seq);
  return seqs;
}

TEST_P(StoreContract, RaisesTheEpochAndKeepsTheHoldOfOneProcess) {
  const OpenResult first = Open();
  EXPECT_GE(first.epoch, 1) << "0 is no epoch";
  EXPECT_EQ(first.held_since, first.epoch);
  EXPECT_EQ(first.cursor, 0);
  EXPECT_EQ(first.rejects_total, 0U);
  const OpenResult second = Open();
  EXPECT_GT(second.epoch, first.epoch);
  EXPECT_EQ(second.held_since, first.held_since);
}

TEST_P(StoreContract, NeverGivesAnEpochTwice) {
  std::vector<storage::OpenRequest> requests;
  for (const char* name : {"a", "b", "c"}) {
    requests.push_back(Request());
    requests.back().robot = Robot(name);
  }
  std::vector<storage::Epoch> epochs;
  const auto open_all = [&](std::uint8_t process) {
    const auto results = store_->Process(process).OpenStreams(requests);
    ASSERT_TRUE(results.ok()) << results.status();
    for (const OpenResult& result : *results) epochs.push_back(result.epoch);
  };
  open_all(kProcess);
  open_all(kProcess);
  open_all(kOther);
  std::vector<storage::AdoptRequest> adopts;
  adopts.reserve(requests.size());
  for (const storage::OpenRequest& request : requests) {
    adopts.push_back({request.robot, storage::ProcessId{kOther}, 0});
  }
  const auto adopted = store_->Process(3).Adopt(adopts);
  ASSERT_TRUE(adopted.ok()) << adopted.status();
  for (const storage::AdoptResult& result : *adopted) {
    epochs.push_back(result.held_since.value_or(0));
  }
  ASSERT_THAT(epochs, SizeIs(12));
  EXPECT_THAT(std::set<storage::Epoch>(epochs.begin(), epochs.end()), SizeIs(12));
  for (std::size_t i = requests.size(); i < epochs.size(); ++i) {
    EXPECT_GT(epochs[i], epochs[i - requests.size()]) << "of one robot a later one is greater";
  }
}

TEST_P(StoreContract, SaysWhetherItKnewTheRobot) {
  EXPECT_FALSE(Open().was_known);
  EXPECT_TRUE(Open().was_known);
  EXPECT_TRUE(Open(Request(), kOther).was_known);
  storage::OpenRequest other = Request();
  other.robot = Robot("b");
  EXPECT_FALSE(Open(other).was_known) << "another's epochs say nothing of it";
  const std::vector<storage::OpenRequest> both = {other, Request()};
  const auto results = store_->Process(kProcess).OpenStreams(both);
  ASSERT_TRUE(results.ok()) << results.status();
  for (const OpenResult& result : *results) EXPECT_TRUE(result.was_known);
  store_->DeleteRobotRow(robot_->ruri);
  EXPECT_FALSE(Open().was_known) << "its row is new, whatever else there is of it";
}

TEST_P(StoreContract, FencesWhoHeldARobotBeforeItsRowWentAndCameAnew) {
  const OpenResult stale = Open();
  Commit({Good(1, Fault("f"))});
  const storage::CommitRecord of_stale = Good(2, Fault("g"));
  store_->DeleteRobotRow(robot_->ruri);
  const OpenResult anew = Open(Request(), kOther);
  EXPECT_GT(anew.held_since, stale.held_since);
  EXPECT_EQ(anew.held_since, anew.epoch);
  EXPECT_EQ(anew.cursor, 1) << "its session stayed";
  EXPECT_THAT(Commit({of_stale}), ElementsAre(OutcomeKind::kFenced));
  EXPECT_THAT(History(), SizeIs(1));
  EXPECT_THAT(Commit({Good(2, Fault("g"))}, kOther), ElementsAre(OutcomeKind::kStored));
  EXPECT_GT(Open().held_since, anew.held_since) << "and so it goes on";
}

TEST_P(StoreContract, AnswersEachRequestOfACallInOrder) {
  storage::OpenRequest other = Request();
  other.robot = Robot("b");
  const std::vector<storage::OpenRequest> requests = {Request(), other, Request()};
  const auto results = store_->Process(kProcess).OpenStreams(requests);
  ASSERT_TRUE(results.ok()) << results.status();
  ASSERT_THAT(*results, SizeIs(3));
  EXPECT_EQ((*results)[0].held_since, (*results)[0].epoch);
  EXPECT_EQ((*results)[1].held_since, (*results)[1].epoch);
  EXPECT_NE((*results)[0].epoch, (*results)[1].epoch);
  EXPECT_GT((*results)[2].epoch, (*results)[0].epoch);
  EXPECT_EQ((*results)[2].held_since, (*results)[0].held_since);
  EXPECT_FALSE((*results)[0].was_known);
  EXPECT_FALSE((*results)[1].was_known);
  EXPECT_TRUE(store_->Process(kProcess).OpenStreams({}).ok());
}

TEST_P(StoreContract, TellsAProcessThatAnotherHadTheRobotInBetween) {
  const OpenResult first = Open();
  const OpenResult between = Open(Request(), kOther);
  EXPECT_GT(between.epoch, first.epoch);
  EXPECT_EQ(between.held_since, between.epoch);
  const OpenResult again = Open();
  EXPECT_GT(again.held_since, between.held_since);
  EXPECT_NE(again.held_since, first.held_since);
}

TEST_P(StoreContract, FencesTheRecordsOfAnOlderHoldAlone) {
  Open();
  storage::CommitRecord of_a = Good(1, Fault("f"));
  storage::OpenRequest of_other_robot = Request();
  of_other_robot.robot = Robot("b");
  Open(of_other_robot);
  storage::CommitRecord of_b = Good(1, Fault("f"));
  of_b.robot = Robot("b");

  Open(Request(), kOther);
  EXPECT_THAT(Commit({of_a, of_b}), ElementsAre(OutcomeKind::kFenced, OutcomeKind::kStored));
  EXPECT_THAT(History(), SizeIs(1));
  EXPECT_THAT(Commit({Good(1, Fault("g"))}, kOther), ElementsAre(OutcomeKind::kStored));
  EXPECT_THAT(Commit({of_a}), ElementsAre(OutcomeKind::kFenced));
}

TEST_P(StoreContract, DropsTheGapsOfAnOlderHold) {
  Open();
  const storage::GapItem gap = Gap(1, 2);
  Open(Request(), kOther);
  CommitGaps({gap});
  EXPECT_THAT(Gaps(), SizeIs(0));
}

TEST_P(StoreContract, ContinuesTheCursorInAnotherProcess) {
  Open();
  Commit({Good(6)});
  EXPECT_EQ(Open(Request(), kOther).cursor, 6);
  EXPECT_THAT(Commit({Good(6), Good(7)}, kOther),
              ElementsAre(OutcomeKind::kDuplicate, OutcomeKind::kStored));
}

TEST_P(StoreContract, KeepsNothingOfAnOpenThatFails) {
  store_->FailNextWrite(kProcess);
  const storage::OpenRequest request = Request();
  EXPECT_EQ(store_->Process(kProcess).OpenStreams({&request, 1}).status().code(),
            absl::StatusCode::kUnavailable);
  const OpenResult first = Open();
  EXPECT_FALSE(first.was_known);
  store_->LoseNextAnswer(kProcess);
  EXPECT_FALSE(store_->Process(kProcess).OpenStreams({&request, 1}).ok());
  const OpenResult result = Open();
  EXPECT_GT(result.epoch, first.epoch);
  EXPECT_EQ(result.held_since, first.held_since);
}

TEST_P(StoreContract, ReturnsTheRejectsAboveWhatIsSettled) {
  Open();
  Commit({Bad(2), Good(3), Bad(5), Bad(9)});
  storage::OpenRequest request = Request();
  OpenResult result = Open(request);
  ASSERT_THAT(result.rejects, SizeIs(3));
  EXPECT_EQ(result.rejects[0].seq, 2);
  EXPECT_EQ(result.rejects[1].seq, 5);
  EXPECT_EQ(result.rejects[2].seq, 9);
  EXPECT_EQ(result.rejects[1].rejection, BadReason());
  request.settled_seq = 5;
  result = Open(request);
  ASSERT_THAT(result.rejects, SizeIs(1));
  EXPECT_EQ(result.rejects[0].seq, 9);
  request.settled_seq = model::kSeqMax;
  EXPECT_THAT(Open(request).rejects, SizeIs(0));
  request.settled_seq = 0;
  request.session = Session(2);
  EXPECT_THAT(Open(request).rejects, SizeIs(0));
}

TEST_P(StoreContract, SaysHowManyRejectsThereAreBesideThoseThatItReturns) {
  Open();
  std::vector<storage::CommitRecord> records;
  for (model::Seq seq = 1; seq <= storage::kOpenRejectsMax; ++seq) records.push_back(Bad(seq, ""));
  Commit(std::move(records));
  OpenResult result = Open();
  EXPECT_THAT(result.rejects, SizeIs(storage::kOpenRejectsMax));
  EXPECT_EQ(result.rejects_total, storage::kOpenRejectsMax);
  Commit({Bad(storage::kOpenRejectsMax + 1, "")});
  result = Open();
  EXPECT_THAT(result.rejects, SizeIs(storage::kOpenRejectsMax));
  EXPECT_EQ(result.rejects.back().seq, storage::kOpenRejectsMax) << "the lowest";
  EXPECT_EQ(result.rejects_total, storage::kOpenRejectsMax + 1);
  storage::OpenRequest request = Request();
  request.settled_seq = 1;
  request.rejects_max = 2;
  result = Open(request);
  EXPECT_THAT(SeqsOf(result.rejects), ElementsAre(2, 3));
  EXPECT_EQ(result.rejects_total, storage::kOpenRejectsMax);
}

TEST_P(StoreContract, ReturnsAsManyRejectsOfEachStreamAsItAsksFor) {
  Open();
  Commit({Bad(1, ""), Bad(2, ""), Bad(3, "")});
  std::vector<storage::OpenRequest> requests = {Request(), Request()};
  requests[0].rejects_max = 1;
  requests[1].robot = std::make_shared<const model::RobotId>(model::RobotId{"rcan://b", "fleet"});
  const auto results = store_->Process(kProcess).OpenStreams(requests);
  ASSERT_TRUE(results.ok()) << results.status();
  EXPECT_THAT(SeqsOf((*results)[0].rejects), ElementsAre(1));
  EXPECT_EQ((*results)[0].rejects_total, 3U);
  EXPECT_EQ((*results)[1].rejects_total, 0U);
}

TEST_P(StoreContract, ReadsRejectsByPages) {
  Open();
  Commit({Bad(2, "a"), Good(3), Bad(5, "b"), Bad(6, "c"), Bad(9, "d")});
  storage::RejectsQuery query{
      .ruri = robot_->ruri, .session = Session(1), .above = 2, .through = 9, .rows_max = 2};
  const auto read = [&] {
    const auto rows = store_->reader().Rejects(query);
    EXPECT_TRUE(rows.ok()) << rows.status();
    return rows.value_or(std::vector<storage::StoredReject>());
  };
  const std::vector<storage::StoredReject> first = read();
  EXPECT_THAT(SeqsOf(first), ElementsAre(5, 6));
  EXPECT_EQ(first[0].rejection, BadReason());
  query.above = 6;
  EXPECT_THAT(SeqsOf(read()), ElementsAre(9));
  query.through = 8;
  EXPECT_THAT(read(), SizeIs(0));
  query.session = Session(2);
  EXPECT_THAT(read(), SizeIs(0)) << "a session that is not known";
  query.ruri = "rcan://unknown";
  EXPECT_THAT(read(), SizeIs(0));
}

TEST_P(StoreContract, ForgetsTheSessionThatWasUsedLongestAgo) {
  Open();
  for (std::uint8_t number = 1; number <= storage::kSessionsPerRobotMax; ++number) {
    storage::CommitRecord record = Good(number);
    record.session = Session(number);
    record.received_at = Time(number);
    Commit({record});
  }
  // Session 1 is used again, so that 2 is the oldest.
  storage::OpenRequest request = Request();
  request.at = Time(100);
  Open(request);
  request.session = Session(100);
  Open(request);
  EXPECT_EQ(Open(Request()).cursor, 1);
  request.session = Session(3);
  EXPECT_EQ(Open(request).cursor, 3);
  request.session = Session(2);
  EXPECT_EQ(Open(request).cursor, 0);
}

TEST_P(StoreContract, KeepsTheSessionThatIsOpenedThoughTheClockWasSetBack) {
  Open();
  for (std::uint8_t number = 1; number <= storage::kSessionsPerRobotMax; ++number) {
    storage::CommitRecord record = Good(number);
    record.session = Session(number);
    record.received_at = Time(number);
    Commit({record});
  }
  storage::OpenRequest request = Request();
  request.session = Session(100);
  request.at = Time(-1);
  Open(request);
  EXPECT_EQ(Open(Request()).cursor, 0) << "the oldest of the others went";
}

TEST_P(StoreContract, NeverForgetsASessionThatIsHeld) {
  Open();
  std::vector<model::SessionId> held;
  for (std::uint8_t number = 1; number <= storage::kSessionsPerRobotMax; ++number) {
    storage::CommitRecord record = Good(number);
    record.session = Session(number);
    Commit({record});
    held.push_back(Session(number));
  }
  storage::OpenRequest request = Request();
  request.at = Time(-1);  // a clock that was set back: the new session seems the oldest
  request.session = Session(100);
  request.sessions_held = held;
  Open(request);
  storage::CommitRecord record = Good(70);
  record.session = Session(100);
  EXPECT_THAT(Commit({record}), Each(OutcomeKind::kStored));
  EXPECT_EQ(Open(request).cursor, 70);
  for (std::uint8_t number = 1; number <= storage::kSessionsPerRobotMax; ++number) {
    request.session = Session(number);
    EXPECT_EQ(Open(request).cursor, number);
  }
}

TEST_P(StoreContract, BeginsAnewWithASessionThatWasForgotten) {
  Open();
  Commit({Bad(1), Good(2)});
  storage::OpenRequest request = Request();
  request.at = Time(10);
  for (std::uint8_t number = 2; number <= storage::kSessionsPerRobotMax + 1; ++number) {
    request.session = Session(number);
    Open(request);
  }
  const OpenResult result = Open();
  EXPECT_EQ(result.cursor, 0);
  EXPECT_THAT(result.rejects, SizeIs(0));
  EXPECT_THAT(Quarantine(), SizeIs(1));
  EXPECT_THAT(Commit({Good(1), Good(2)}), Each(OutcomeKind::kStored));
  // The quarantine row of the forgotten session is not this one's.
  EXPECT_THAT(Commit({Good(1)}), ElementsAre(OutcomeKind::kDuplicate));
  EXPECT_THAT(Open().rejects, SizeIs(0));
}

TEST_P(StoreContract, ListsRobotsByRuri) {
  for (const char* name : {"c", "a", "b"}) {
    storage::OpenRequest request = Request();
    request.robot = Robot(name);
    Open(request);
  }
  storage::OpenRequest request = Request();
  request.robot = Robot("a", "f2");
  request.at = Time(5);
  Open(request);
  auto rows = store_->reader().Robots(2);
  ASSERT_TRUE(rows.ok()) << rows.status();
  ASSERT_THAT(*rows, SizeIs(2));
  EXPECT_EQ((*rows)[0].robot, *request.robot);
  EXPECT_EQ((*rows)[0].first_seen, Time());
  EXPECT_EQ((*rows)[0].last_seen, Time(5));
  EXPECT_EQ((*rows)[1].robot, *Robot("b"));

  storage::CommitRecord record = Good(1);
  record.robot = request.robot;
  record.received_at = Time(9);
  Commit({record});
  rows = store_->reader().Robots(10);
  ASSERT_TRUE(rows.ok()) << rows.status();
  ASSERT_THAT(*rows, SizeIs(3));
  EXPECT_EQ((*rows)[0].last_seen, Time(9));
}

TEST_P(StoreContract, ListsTheFleetsBeyondAsciiOnce) {
  const auto fleets = [this](std::uint32_t most) {
    auto read = store_->reader().FleetsBeyondAscii(most);
    EXPECT_TRUE(read.ok()) << read.status();
    return read.ok() ? *std::move(read) : std::vector<std::string>();
  };
  EXPECT_THAT(fleets(9), SizeIs(0));
  const std::string odd = "no\xE2\x80\x8Brth";  // U+200B
  const auto open = [this](const char* name, const std::string& fleet) {
    storage::OpenRequest request = Request();
    request.robot = Robot(name, fleet);
    Open(request);
  };
  open("a", "north");
  open("b", "~ plain\t");
  open("c", "東京");
  open("d", odd);
  open("e", "Köln");
  open("f", odd);
  open("g", "Łódź");
  open("g", "north");
  storage::OpenRequest nobody = Request();
  nobody.robot = std::make_shared<const model::RobotId>(model::RobotId{"cyberwave:Ö", "Ö"});
  Open(nobody);
  EXPECT_THAT(fleets(9), ElementsAre("Köln", odd, "東京"));
  EXPECT_THAT(fleets(2), ElementsAre("Köln", odd));
}

TEST_P(StoreContract, ListsRobotsWithTheSessionThatWasUsedLast) {
  const auto last = [this] {
    const auto rows = store_->reader().Robots(10);
    EXPECT_TRUE(rows.ok() && !rows->empty()) << rows.status();
    return rows.ok() && !rows->empty() ? rows->front().last_session : std::nullopt;
  };
  const auto commit = [this](std::uint8_t session, model::Seq seq, std::int64_t at_ms) {
    storage::CommitRecord record = At(at_ms, Good(seq));
    record.session = Session(session);
    Commit({record});
  };
  Open();
  ASSERT_TRUE(last());
  EXPECT_EQ(last()->session, session_);
  EXPECT_EQ(last()->settled_seq, 0) << "opened, and nothing committed yet";
  commit(5, 7, 20);
  commit(3, 9, 10);
  EXPECT_EQ(last()->session, Session(5));
  EXPECT_EQ(last()->settled_seq, 7);
  commit(3, 12, 30);
  EXPECT_EQ(last()->session, Session(3));
  EXPECT_EQ(last()->settled_seq, 12);
  commit(4, 2, 30);
  EXPECT_EQ(last()->session, Session(4)) << "of two at one time, the one with the higher id";
  storage::OpenRequest request = Request();
  request.at = Time(40);
  Open(request);
  EXPECT_EQ(last()->session, session_) << "a stream uses its session as well";
  EXPECT_EQ(last()->settled_seq, 0);
}

}  // namespace
}  // namespace uplink::testing
