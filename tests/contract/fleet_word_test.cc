// Who may move a robot from one fleet to another, and what becomes of a stream that may not.
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "storage/bounds.h"
#include "tests/contract/store_contract.h"

namespace uplink::testing {
namespace {

using storage::FleetWord;
using storage::OpenResult;
using storage::OutcomeKind;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Optional;
using ::testing::SizeIs;

class FleetWordContract : public StoreContract {
 protected:
  /// A stream of a gateway of that fleet, which speaks for all robots of it.
  storage::OpenRequest Through(const std::string& fleet, const std::string& name = "a") {
    storage::OpenRequest request = Request();
    request.robot = Robot(name, fleet);
    request.session = Session(9);
    request.at = Time(50);
    request.fleet_word = FleetWord::kMatches;
    return request;
  }
  /// In one call. The hold of the fixture's records stays what it is.
  std::vector<OpenResult> OpenAll(const std::vector<storage::OpenRequest>& requests,
                                  std::uint8_t process = kProcess) {
    auto results = store_->Process(process).OpenStreams(requests);
    EXPECT_TRUE(results.ok()) << results.status();
    return results.ok() ? *std::move(results) : std::vector<OpenResult>(requests.size());
  }
  OpenResult OpenOne(const storage::OpenRequest& request, std::uint8_t process = kProcess) {
    return OpenAll({request}, process).front();
  }
  storage::RobotRow Row() {
    const auto rows = store_->reader().Robots(10);
    EXPECT_TRUE(rows.ok() && rows->size() == 1) << rows.status();
    return rows.ok() && !rows->empty() ? rows->front() : storage::RobotRow();
  }
};

TEST_P(FleetWordContract, AWordThatMovesNothingTakesNoRobotOfAnotherFleet) {
  const OpenResult own = Open();
  Commit({Bad(2), Good(3)});
  for (const std::uint8_t process : {kOther, kProcess}) {
    const OpenResult refused = OpenOne(Through("f2"), process);
    EXPECT_FALSE(refused.taken);
    EXPECT_THAT(refused.other_fleet, Optional(std::string("f1")));
    EXPECT_EQ(refused.epoch, 0U);
    EXPECT_EQ(refused.held_since, 0U);
    EXPECT_EQ(refused.cursor, 0U) << "how far its sessions are is not told";
    EXPECT_THAT(refused.rejects, IsEmpty());
    EXPECT_EQ(refused.rejects_total, 0U);
    EXPECT_FALSE(refused.presence);
    EXPECT_EQ(refused.latest_kinds, 0U);
  }
  EXPECT_EQ(Row().robot, *robot_);
  EXPECT_EQ(Row().last_seen, Time());
  EXPECT_THAT(Commit({Good(4)}), ElementsAre(OutcomeKind::kStored)) << "its holder holds it";
  EXPECT_EQ(Open().held_since, own.held_since);
}

TEST_P(FleetWordContract, ARefusedStreamTellsNothingOfTheSessionThatItNames) {
  Open();
  Commit({Bad(2), Good(3)});
  storage::OpenRequest request = Through("f2");
  request.session = Session(1);
  request.settled_seq = 3;
  const OpenResult refused = OpenOne(request);
  EXPECT_EQ(refused.cursor, 0U);
  EXPECT_THAT(refused.rejects, IsEmpty());
  EXPECT_EQ(refused.rejects_total, 0U);
  request.settled_seq = 0;
  EXPECT_EQ(OpenOne(request).rejects_total, 0U);
}

TEST_P(FleetWordContract, ARefusedStreamTouchesNoSession) {
  Open();
  for (std::uint8_t number = 2; number <= storage::kSessionsPerRobotMax; ++number) {
    storage::OpenRequest request = Request();
    request.session = Session(number);
    request.at = Time(number);
    Open(request);
  }
  Commit({Good(1)});
  OpenOne(Through("f2"));
  OpenOne(Through("f2"), kOther);
  EXPECT_EQ(CursorNow(), 1U) << "the session that was used longest ago is there";
}

TEST_P(FleetWordContract, AWordThatMovesNothingStandsForNewRobotsAndThoseOfItsFleet) {
  const OpenResult made = OpenOne(Through("f2"));
  EXPECT_TRUE(made.taken);
  EXPECT_FALSE(made.other_fleet);
  EXPECT_FALSE(made.was_known);
  EXPECT_EQ(Row().robot.fleet, "f2");
  const OpenResult again = OpenOne(Through("f2"), kOther);
  EXPECT_TRUE(again.taken);
  EXPECT_FALSE(again.other_fleet);
  EXPECT_TRUE(again.was_known);
  EXPECT_GT(again.epoch, made.epoch);
}

TEST_P(FleetWordContract, AWordThatMovesDecidesFromThenOn) {
  EXPECT_TRUE(OpenOne(Through("f2")).taken);
  Open();
  EXPECT_EQ(Row().robot.fleet, "f1");
  EXPECT_THAT(OpenOne(Through("f2")).other_fleet, Optional(std::string("f1")));
  EXPECT_TRUE(OpenOne(Through("f1")).taken);
}

TEST_P(FleetWordContract, AWordThatMovesTellsTheFormerFleet) {
  EXPECT_FALSE(Open().moved_from) << "it is new";
  EXPECT_FALSE(Open().moved_from) << "it stays";
  EXPECT_FALSE(OpenOne(Through("f2")).moved_from) << "it is refused";
  storage::OpenRequest moves = Request();
  moves.robot = Robot("a", "f2");
  for (const std::uint8_t process : {kProcess, kOther}) {
    const auto results = OpenAll({moves, moves, Request(), Through("f1")}, process);
    ASSERT_THAT(results, SizeIs(4));
    EXPECT_THAT(results[0].moved_from, Optional(std::string("f1")));
    EXPECT_FALSE(results[1].moved_from);
    EXPECT_THAT(results[2].moved_from, Optional(std::string("f2")));
    EXPECT_FALSE(results[3].moved_from);
  }
  moves.stream = storage::StreamState::kEnded;
  const OpenResult ended = OpenOne(moves, kProcess);
  EXPECT_EQ(ended.moved_from.has_value(), ended.taken);
}

TEST_P(FleetWordContract, ARobotWithoutARowIsOfNoFleet) {
  Open();
  store_->DeleteRobotRow(robot_->ruri);
  EXPECT_TRUE(OpenOne(Through("f2")).taken);
  EXPECT_EQ(Row().robot.fleet, "f2");
}

TEST_P(FleetWordContract, AnswersEachRequestOfACallByItsOwnWord) {
  Open();
  storage::OpenRequest moves = Request();
  moves.robot = Robot("a", "f2");
  const auto results =
      OpenAll({Through("f2"), Through("f2", "b"), moves, Through("f2"), Through("f1")});
  ASSERT_THAT(results, SizeIs(5));
  EXPECT_THAT(results[0].other_fleet, Optional(std::string("f1")));
  EXPECT_TRUE(results[1].taken) << "its neighbour's row was not there";
  EXPECT_TRUE(results[2].taken);
  EXPECT_TRUE(results[3].taken) << "the request before moved it";
  EXPECT_FALSE(results[3].other_fleet);
  EXPECT_THAT(results[4].other_fleet, Optional(std::string("f2")));
}

TEST_P(FleetWordContract, AnEndedStreamOfAnotherFleetIsToldTheFleet) {
  Open();
  storage::OpenRequest request = Through("f2");
  request.stream = storage::StreamState::kEnded;
  const OpenResult refused = OpenOne(request, kOther);
  EXPECT_FALSE(refused.taken);
  EXPECT_THAT(refused.other_fleet, Optional(std::string("f1")));
}

INSTANTIATE_TEST_SUITE_P(Stores, FleetWordContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
