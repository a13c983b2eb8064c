#include <gmock/gmock.h>

#include "storage/bounds.h"
#include "storage/refusal.h"
#include "tests/contract/claim_contract.h"

/// Requests of drones to their operators.
namespace uplink::testing {
namespace {

using model::OperatorRequest;
using model::OperatorRequestKind;
using storage::OperatorRequestRow;
using storage::OutcomeKind;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::int64_t kDayMs = 86'400'000;

class RequestsContract : public ClaimContract {
 protected:
  RequestsContract() { Claim(); }

  static OperatorRequest Opened(const std::string& id) {
    return {.unix_time_ms = 1,
            .request_id = id,
            .kind = OperatorRequestKind::kConfirmDeliveryComplete,
            .text = "clear?",
            .requested_at_ms = 7,
            .open = true};
  }
  static OperatorRequest Closed(const std::string& id) {
    OperatorRequest request = Opened(id);
    request.open = false;
    return request;
  }
  /// A sample of these changes, at that time.
  std::vector<OutcomeKind> Change(std::int64_t after_ms, std::vector<OperatorRequest> changes) {
    std::vector<storage::CommitContent> contents(changes.begin(), changes.end());
    storage::SampleMark mark = Mark(0);
    mark.digest[4] = ++samples_;
    mark.digest[5] = static_cast<std::uint8_t>(number_ >> 8U);
    mark.digest[6] = static_cast<std::uint8_t>(number_);
    std::vector<storage::CommitRecord> records = Sample(mark, std::move(contents));
    for (storage::CommitRecord& record : records) record.received_at = Time(after_ms);
    return Commit(std::move(records));
  }
  std::vector<OperatorRequestRow> Requests(const storage::OperatorRequestsQuery& query = {}) {
    return RowsOf(store_->reader().OperatorRequests(query));
  }
  std::vector<std::string> IdsOf(const storage::OperatorRequestsQuery& query = {}) {
    std::vector<std::string> ids;
    for (const OperatorRequestRow& row : Requests(query)) ids.push_back(row.request_id);
    return ids;
  }
  static storage::OperatorRequestsQuery OnlyOpen() { return {.rows = {}, .open = true}; }

  std::uint8_t samples_ = 0;
};

TEST_P(RequestsContract, AreOpenUntilTheyAreClosed) {
  EXPECT_THAT(Change(1, {Opened("r")}), ElementsAre(OutcomeKind::kStored));
  ASSERT_THAT(Requests(), SizeIs(1));
  const OperatorRequestRow row = Requests()[0];
  EXPECT_EQ(row.robot, *robot_);
  EXPECT_EQ(row.request_id, "r");
  EXPECT_EQ(row.kind, OperatorRequestKind::kConfirmDeliveryComplete);
  EXPECT_EQ(row.text, "clear?");
  EXPECT_EQ(row.requested_at_ms, 7);
  EXPECT_EQ(row.opened_at, Time(1));
  EXPECT_EQ(row.closed_at_ms, 0);
  EXPECT_THAT(IdsOf(OnlyOpen()), ElementsAre("r"));
  EXPECT_THAT(Change(5, {Closed("r")}), ElementsAre(OutcomeKind::kStored));
  EXPECT_THAT(IdsOf(OnlyOpen()), IsEmpty());
  ASSERT_THAT(Requests(), SizeIs(1));
  EXPECT_EQ(Requests()[0].opened_at, Time(1));
  EXPECT_EQ(Requests()[0].closed_at_ms, kNowMs + 5);
}

TEST_P(RequestsContract, AreFoundByRobotFleetAndTime) {
  Change(1, {Opened("r")});
  Change(2, {Opened("s")});
  EXPECT_THAT(IdsOf({.rows = {.ruris = {robot_->ruri}}}), ElementsAre("s", "r"));
  EXPECT_THAT(IdsOf({.rows = {.ruris = {Robot("b")->ruri}}}), IsEmpty());
  EXPECT_THAT(IdsOf({.rows = {.fleets = {"f1"}}, .open = true}), ElementsAre("s", "r"));
  EXPECT_THAT(IdsOf({.rows = {.fleets = {"f2"}}}), IsEmpty());
  storage::OperatorRequestsQuery query = OnlyOpen();
  query.rows.from = Time(2);
  EXPECT_THAT(IdsOf(query), ElementsAre("s"));
  query = {};
  query.rows.to = Time(1);
  EXPECT_THAT(IdsOf(query), ElementsAre("r"));
  query = {};
  query.rows.page_size = 1;
  query.rows.page_token = store_->reader().OperatorRequests(query)->next_token;
  EXPECT_THAT(IdsOf(query), ElementsAre("r"));
}

TEST_P(RequestsContract, KeepTheirPlaceWhenTheyAreOpenedAgain) {
  Change(1, {Opened("r")});
  Change(2, {Opened("s")});
  OperatorRequest other = Opened("r");
  other.text = "now?";
  Change(3, {other});
  EXPECT_THAT(IdsOf(), ElementsAre("s", "r"));
  EXPECT_EQ(Requests()[1].text, "now?");
  EXPECT_EQ(Requests()[1].opened_at, Time(1));
}

TEST_P(RequestsContract, AreAnotherRowAfterTheirEnd) {
  Change(1, {Opened("r")});
  EXPECT_THAT(Change(2, {Closed("r"), Opened("r"), Closed("r"), Opened("r")}),
              Each(OutcomeKind::kStored));
  EXPECT_THAT(IdsOf(), ElementsAre("r", "r", "r"));
  EXPECT_THAT(IdsOf(OnlyOpen()), ElementsAre("r"));
  EXPECT_EQ(Requests(OnlyOpen())[0].opened_at, Time(2));
}

TEST_P(RequestsContract, AreCountedWhileTheyAreOpen) {
  Change(1, {Opened("r"), Opened("s"), Opened("t"), Closed("r")});
  const std::vector<std::string> ruris = {robot_->ruri, Robot("b")->ruri};
  const auto counts = store_->reader().OpenRequestCounts(ruris);
  ASSERT_TRUE(counts.ok()) << counts.status();
  EXPECT_THAT(*counts, ElementsAre(storage::OpenRequestCount{robot_->ruri, 2}));
}

TEST_P(RequestsContract, ThatAreNotOpenAreClosedWithoutARow) {
  EXPECT_THAT(Change(1, {Closed("r")}), ElementsAre(OutcomeKind::kStored));
  EXPECT_THAT(Requests(), IsEmpty());
}

TEST_P(RequestsContract, AreRefusedAtTheBoundAlone) {
  std::vector<OperatorRequest> changes;
  for (std::size_t i = 1; i < storage::kOpenRequestsPerRobotMax; ++i) {
    changes.push_back(Opened(std::to_string(i)));
  }
  EXPECT_THAT(Change(1, changes), Each(OutcomeKind::kStored));
  EXPECT_THAT(Change(2, {Opened("a"), Opened("b"), Opened("1"), Closed("2"), Opened("c")}),
              ElementsAre(OutcomeKind::kStored, OutcomeKind::kRefused, OutcomeKind::kStored,
                          OutcomeKind::kStored, OutcomeKind::kStored));
  EXPECT_THAT(IdsOf(OnlyOpen()), SizeIs(storage::kOpenRequestsPerRobotMax));
  ASSERT_THAT(Quarantine(), SizeIs(1));
  EXPECT_EQ(Quarantine()[0].rejection, storage::TooManyOpenRequests());
}

TEST_P(RequestsContract, LoseTheOldestThatAreClosedOverTheirBound) {
  Change(0, {Opened("open")});
  for (std::size_t i = 0; i <= storage::kClosedRequestsPerRobotMax; i += 13) {
    std::vector<OperatorRequest> changes;
    for (std::size_t j = i; j < i + 13; ++j) changes.push_back(Opened(std::to_string(j)));
    for (std::size_t j = i; j < i + 13; ++j) changes.push_back(Closed(std::to_string(j)));
    EXPECT_THAT(Change(static_cast<std::int64_t>(i) + 1, changes), Each(OutcomeKind::kStored));
  }
  // 77 samples of 13.
  const std::string next =
      store_->reader().OperatorRequests({.rows = {.page_size = 1'000}})->next_token;
  ASSERT_NE(next, "");
  const auto rest = IdsOf({.rows = {.page_size = 1'000, .page_token = next}});
  EXPECT_THAT(rest, ElementsAre("open"));
}

TEST_P(RequestsContract, GoByTheirAgeOnceTheyAreClosed) {
  storage::StoreRules rules;
  rules.retain_history = std::chrono::hours(48);
  Fresh(rules);
  Claim();
  Change(0, {Opened("old"), Opened("open"), Opened("late"), Closed("old")});
  Change(5 * kDayMs, {Closed("late")});
  ASSERT_TRUE(store_->Process(kProcess).Retain(Time(5 * kDayMs)).ok());
  EXPECT_THAT(IdsOf(), ElementsAre("late", "open"));
}

TEST_P(RequestsContract, GoWithTheirRobot) {
  Change(1, {Opened("r"), Opened("s"), Closed("s")});
  store_->RemoveRobot(robot_->ruri);
  EXPECT_THAT(Requests(), IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Stores, RequestsContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
