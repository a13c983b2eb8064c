// Whether a store still has what it told, once it was connected to anew.
#include "storage/compare.h"

#include <gmock/gmock.h>

#include "tests/contract/store_contract.h"

namespace uplink::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class CompareContract : public StoreContract {
 protected:
  storage::ToldRobot Told(model::Seq cursor, storage::Epoch later = 0) const {
    storage::ToldRobot told{
        .ruri = robot_->ruri, .held_since = held_since_ + later, .sessions = {}};
    if (cursor > 0) told.sessions.push_back({session_, cursor});
    return told;
  }
  std::vector<storage::FoundRobot> Compare(const std::vector<storage::ToldRobot>& told,
                                           std::uint8_t process = kProcess) {
    auto found = store_->Process(process).Compare(told);
    EXPECT_TRUE(found.ok()) << found.status();
    return found.value_or(std::vector<storage::FoundRobot>());
  }
};

TEST_P(CompareContract, FindsWhatItTold) {
  Open();
  EXPECT_THAT(Compare({}), IsEmpty());
  Commit({Good(3), Bad(5)});
  storage::Batch batch;
  batch.presence_session = Session(9);
  batch.presence = {{robot_, model::Presence::kOnline, Time(7), 1, held_since_}};
  Commit(batch);
  const storage::FoundRobot as_told{
      .held = true, .presence = storage::StoredPresence{model::Presence::kOnline, Time(7)}};
  // Numbers below the cursor, too: another answer may have been lost.
  for (const model::Seq cursor : {5U, 3U, 0U}) {
    EXPECT_THAT(Compare({Told(cursor)}), ElementsAre(as_told)) << cursor;
  }
  EXPECT_EQ(CursorNow(), 5) << "it changes nothing";
}

TEST_P(CompareContract, FindsACursorThatFell) {
  Open();
  Commit({Good(3)});
  storage::ToldRobot told = Told(4);
  EXPECT_THAT(Compare({told}), ElementsAre(storage::FoundRobot{.held = true, .went_back = true}));
  told.sessions = {{session_, 3}, {Session(2), 1}};
  EXPECT_THAT(Compare({told}), ElementsAre(storage::FoundRobot{.held = true, .went_back = true}))
      << "a session that it does not know has no number";
}

TEST_P(CompareContract, FindsAnOlderHold) {
  Open();
  EXPECT_THAT(Compare({Told(0, 1)}), ElementsAre(storage::FoundRobot{.went_back = true}));
  EXPECT_THAT(Compare({Told(0)}, kOther), ElementsAre(storage::FoundRobot{}))
      << "of another process, and as old";
}

TEST_P(CompareContract, FindsAHoldThatAnotherHasSince) {
  Open();
  const storage::ToldRobot told = Told(9);
  Open(Request(), kOther);
  EXPECT_THAT(Compare({told}), ElementsAre(storage::FoundRobot{}))
      << "it went to another, and nothing went back";
}

TEST_P(CompareContract, FindsEachOfMany) {
  Open();
  Commit({Good(3)});
  const storage::ToldRobot mine = Told(3);
  storage::ToldRobot none = Told(0);
  none.ruri = Robot("none")->ruri;
  storage::OpenRequest request = Request();
  request.robot = Robot("b");
  storage::ToldRobot other = mine;
  other.ruri = request.robot->ruri;
  other.held_since = Open(request).held_since;
  other.sessions = {{session_, 1}};
  EXPECT_THAT(
      Compare({none, other, mine}),
      ElementsAre(storage::FoundRobot{}, storage::FoundRobot{.held = true, .went_back = true},
                  storage::FoundRobot{.held = true}));
}

TEST_P(CompareContract, FindsNothingOfARobotWithoutARow) {
  held_since_ = 4;
  EXPECT_THAT(Compare({Told(0)}), ElementsAre(storage::FoundRobot{}));
  EXPECT_THAT(Compare({Told(2)}), ElementsAre(storage::FoundRobot{.went_back = true}));
}

INSTANTIATE_TEST_SUITE_P(Stores, CompareContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
