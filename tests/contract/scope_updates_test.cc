#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "storage/page_token.h"
#include "tests/contract/store_contract.h"

/// Updates of what is no robot.
namespace uplink::testing {
namespace {

using model::ScopeKind;
using storage::OutcomeKind;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class ScopeUpdateContract : public StoreContract {
 protected:
  ScopeUpdateContract() {
    Open();
    OpenAlso({nobody_, south_});
  }
  static model::ScopeUpdate UpdateOf(const std::string& type,
                                     ScopeKind scope = ScopeKind::kEnvironment,
                                     const std::string& id = kId) {
    return {scope, id, type, R"({"type":")" + type + R"("})", kNowMs - 7};
  }
  static std::vector<std::string> Types(const std::vector<storage::ScopeUpdateRow>& rows) {
    std::vector<std::string> types;
    types.reserve(rows.size());
    for (const storage::ScopeUpdateRow& row : rows) types.push_back(row.update.type);
    return types;
  }
  static storage::RobotRef Nobody(const std::string& prefix, const std::string& fleet) {
    return std::make_shared<const model::RobotId>(
        model::RobotId{storage::NoRobotOf(prefix), fleet});
  }

  static constexpr const char* kId = "eeeeeeee-eeee-4eee-8eee-eeeeeeeeeeee";
  static constexpr const char* kOtherId = "11111111-1111-4111-8111-111111111111";
  const storage::RobotRef nobody_ = Nobody("", "f1");
  const storage::RobotRef south_ = Nobody("south", "f2");
};

TEST_P(ScopeUpdateContract, IsKeptWithEveryField) {
  model::ScopeUpdate update = UpdateOf("weather ' ä");
  update.scope = ScopeKind::kWorkflowRun;
  EXPECT_THAT(Commit({At(5, Update(nobody_, 1, update))}), Each(OutcomeKind::kStored));
  store_->Reopen();
  const auto rows = ScopeUpdates();
  ASSERT_THAT(rows, SizeIs(1));
  EXPECT_EQ(rows[0].robot, *nobody_);
  EXPECT_EQ(rows[0].update, update);
  EXPECT_EQ(rows[0].received_at, Time(5));
}

TEST_P(ScopeUpdateContract, IsWrittenOnceBesideWhatRobotsSay) {
  storage::Batch batch;
  batch.records = {Good(1), Update(nobody_, 1, UpdateOf("a")), Bad(2),
                   Update(nobody_, 2, UpdateOf("b")), Update(nobody_, 2, UpdateOf("copy"))};
  std::vector<OutcomeKind> kinds;
  for (const storage::Outcome& outcome : Commit(batch)) kinds.push_back(outcome.kind);
  EXPECT_THAT(kinds, ElementsAre(OutcomeKind::kStored, OutcomeKind::kStored, OutcomeKind::kStored,
                                 OutcomeKind::kStored, OutcomeKind::kDuplicate));
  store_->LoseNextAnswer(kProcess);
  batch.records = {Update(nobody_, 3, UpdateOf("c")), Update(nobody_, 4, UpdateOf("d"))};
  EXPECT_FALSE(store_->Process(kProcess).Commit(Held(batch)).ok());
  EXPECT_THAT(Commit(batch.records), Each(OutcomeKind::kDuplicate));
  EXPECT_THAT(Types(ScopeUpdates()), ElementsAre("d", "c", "b", "a"));
  EXPECT_THAT(Messages(), SizeIs(1));
}

TEST_P(ScopeUpdateContract, NothingOfACommitThatFailsIsKept) {
  store_->FailNextWrite(kProcess);
  storage::Batch batch;
  batch.records = {Update(nobody_, 1, UpdateOf("a"))};
  EXPECT_FALSE(store_->Process(kProcess).Commit(Held(batch)).ok());
  EXPECT_THAT(ScopeUpdates(), IsEmpty());
  EXPECT_THAT(Commit(batch.records), Each(OutcomeKind::kStored));
}

TEST_P(ScopeUpdateContract, StaysBesideARecordThatTheDatabaseRefuses) {
  store_->RefuseFault("poison");
  EXPECT_THAT(Commit({Update(nobody_, 1, UpdateOf("a")), Good(1, Fault("poison")),
                      Update(nobody_, 2, UpdateOf("b"))}),
              ElementsAre(OutcomeKind::kStored, OutcomeKind::kRefused, OutcomeKind::kStored));
  EXPECT_THAT(Types(ScopeUpdates()), ElementsAre("b", "a"));
}

TEST_P(ScopeUpdateContract, IsFencedAsARobotsReports) {
  storage::OpenRequest taken = Request();
  taken.robot = nobody_;
  ASSERT_TRUE(store_->Process(kOther).OpenStreams({&taken, 1}).ok());
  EXPECT_THAT(Commit({Update(nobody_, 1, UpdateOf("a")), Update(south_, 1, UpdateOf("b"))}),
              ElementsAre(OutcomeKind::kFenced, OutcomeKind::kStored));
  EXPECT_THAT(Types(ScopeUpdates()), ElementsAre("b"));
}

TEST_P(ScopeUpdateContract, IsFoundByScopeIdFleetAndTime) {
  Commit({At(1, Update(nobody_, 1, UpdateOf("a"))),
          At(2, Update(nobody_, 2, UpdateOf("b", ScopeKind::kWorkflowRun))),
          At(3, Update(nobody_, 3, UpdateOf("c", ScopeKind::kEnvironment, kOtherId))),
          At(4, Update(south_, 1, UpdateOf("d")))});
  const auto found = [this](const storage::ScopeUpdatesQuery& query) {
    return Types(ScopeUpdates(query));
  };
  EXPECT_THAT(found({}), ElementsAre("d", "c", "b", "a"));
  EXPECT_THAT(found({.scope = ScopeKind::kEnvironment}), ElementsAre("d", "c", "a"));
  EXPECT_THAT(found({.scope = ScopeKind::kWorkflowRun}), ElementsAre("b"));
  EXPECT_THAT(found({.id = kId}), ElementsAre("d", "b", "a"));
  EXPECT_THAT(found({.scope = ScopeKind::kEnvironment, .id = kOtherId}), ElementsAre("c"));
  EXPECT_THAT(found({.scope = ScopeKind::kWorkflowRun, .id = kOtherId}), IsEmpty());
  EXPECT_THAT(found({.rows = {.fleets = {"f2"}}}), ElementsAre("d"));
  EXPECT_THAT(found({.rows = {.fleets = {"f2"}}, .scope = ScopeKind::kWorkflowRun}), IsEmpty());
  EXPECT_THAT(found({.rows = {.from = Time(2), .to = Time(3)}}), ElementsAre("c", "b"));
}

TEST_P(ScopeUpdateContract, AWalkSeesEachOnceWhileOthersCome) {
  model::Seq seq = 0;
  for (; seq < 7; ++seq) Commit({Update(nobody_, seq + 1, UpdateOf(std::to_string(seq)))});
  storage::ScopeUpdatesQuery query{.rows = {.page_size = 2}, .scope = ScopeKind::kEnvironment};
  std::vector<std::string> seen;
  do {
    const auto page = store_->reader().ScopeUpdates(query);
    ASSERT_TRUE(page.ok()) << page.status();
    for (std::string& type : Types(page->rows)) seen.push_back(std::move(type));
    query.rows.page_token = page->next_token;
    ++seq;
    Commit({At(1, Update(nobody_, seq + 1, UpdateOf("later")))});
  } while (!query.rows.page_token.empty() && seen.size() < 20);
  EXPECT_THAT(seen, ElementsAre("6", "5", "4", "3", "2", "1", "0"));
  query.rows.page_token = storage::EncodePageToken(storage::PageKind::kEvents,
                                                   storage::ListOrder::kNewestFirst, {Time(), 1});
  EXPECT_EQ(store_->reader().ScopeUpdates(query).status().code(),
            absl::StatusCode::kInvalidArgument);
}

INSTANTIATE_TEST_SUITE_P(Stores, ScopeUpdateContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
