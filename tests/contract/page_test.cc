#include <map>
#include <set>

#include <gmock/gmock.h>

#include "storage/page_token.h"
#include "tests/contract/store_contract.h"

namespace uplink::testing {
namespace {

using storage::HistoryQuery;
using ::testing::ElementsAre;
using ::testing::SizeIs;
using ::testing::StartsWith;

TEST_P(StoreContract, ListsTheNewestArrivalFirst) {
  Open();
  std::vector<storage::CommitRecord> records = {Good(1, Fault("old")), Good(2, Fault("new")),
                                                Good(3, Fault("older"))};
  records[0].received_at = Time(10);
  records[1].received_at = Time(20);
  records[2].received_at = Time(5);
  Commit(records);
  std::vector<std::string> ids;
  for (const auto& row : History()) ids.push_back(row.fault.fault_id);
  EXPECT_THAT(ids, ElementsAre("new", "old", "older"));
}

TEST_P(StoreContract, WalksEveryRowOnceWhileRowsAreAdded) {
  Open();
  std::vector<storage::CommitRecord> records;
  std::set<std::string> expected;
  model::Seq seq = 0;
  for (int i = 0; i < 25; ++i) {
    const std::string id = "f" + std::to_string(i);
    records.push_back(Good(++seq, Fault(id)));
    records.back().received_at = Time(i / 10);  // most share their time with others
    expected.insert(id);
  }
  Commit(records);
  std::map<std::string, int> in_history;
  std::map<std::string, int> in_active;
  HistoryQuery history;
  HistoryQuery active;
  history.page_size = 4;
  active.page_size = 4;
  int pages = 0;
  do {
    const auto page = store_->reader().FaultHistory(history);
    ASSERT_TRUE(page.ok()) << page.status();
    for (const auto& row : page->rows) ++in_history[row.fault.fault_id];
    history.page_token = page->next_token;
    const auto active_page = store_->reader().FaultsActive(active);
    ASSERT_TRUE(active_page.ok()) << active_page.status();
    for (const auto& row : active_page->rows) ++in_active[row.fault.fault_id];
    active.page_token = active_page->next_token;
    // Newer rows, and a later raise of a fault that the walk has not reached.
    storage::CommitRecord newer = Good(++seq, Fault("newer" + std::to_string(pages)));
    newer.received_at = Time(100 + pages);
    storage::CommitRecord update = Good(++seq, Fault("f0"));
    update.received_at = Time(100 + pages);
    Commit({newer, update});
    ++pages;
  } while (!history.page_token.empty() && !active.page_token.empty());
  EXPECT_EQ(pages, 7);
  EXPECT_TRUE(history.page_token.empty() && active.page_token.empty());
  for (const std::string& id : expected) {
    EXPECT_EQ(in_history[id], 1) << id;
    EXPECT_EQ(in_active[id], 1) << id;
  }
  EXPECT_EQ(in_history.size(), expected.size()) << "no row that came later";
}

TEST_P(StoreContract, GivesNoTokenWithTheLastPage) {
  Open();
  Commit({Good(1, Fault("f")), Good(2, Fault("g")), Bad(3), Bad(4)});
  CommitGaps({Gap(5, 5), Gap(7, 7)});
  HistoryQuery query;
  query.page_size = 2;
  EXPECT_EQ(store_->reader().FaultHistory(query)->next_token, "");
  EXPECT_EQ(store_->reader().FaultsActive(query)->next_token, "");
  EXPECT_EQ(store_->reader().Quarantine({.rows = query})->next_token, "");
  EXPECT_EQ(store_->reader().Gaps(query)->next_token, "");
  query.page_size = 1;
  EXPECT_NE(store_->reader().FaultHistory(query)->next_token, "");
  EXPECT_NE(store_->reader().FaultsActive(query)->next_token, "");
  EXPECT_NE(store_->reader().Quarantine({.rows = query})->next_token, "");
  EXPECT_NE(store_->reader().Gaps(query)->next_token, "");
}

TEST_P(StoreContract, FiltersByRobotFleetAndTime) {
  Open();
  OpenAlso({Robot("b"), Robot("c")});
  const auto put = [this](const storage::RobotRef& robot, std::int64_t at) {
    storage::CommitRecord record = Good(static_cast<model::Seq>(at), Fault("f"));
    storage::CommitRecord bad = Bad(static_cast<model::Seq>(at) + 100'000);
    storage::GapItem gap = Gap(static_cast<model::Seq>(at), static_cast<model::Seq>(at));
    for (SystemTime* time : {&record.received_at, &bad.received_at, &gap.seen_at}) *time = Time(at);
    record.robot = bad.robot = gap.robot = robot;
    record.session = bad.session = gap.session = Session(static_cast<std::uint8_t>(at));
    storage::Batch batch;
    batch.records = {record, bad};
    batch.gaps = {gap};
    Commit(batch);
  };
  put(Robot("a", "f1"), 10);
  put(Robot("a", "f1"), 20);
  put(Robot("b", "f1"), 30);
  put(Robot("c", "f2"), 40);
  const auto counts = [this](const HistoryQuery& query) {
    EXPECT_EQ(Quarantine(query).size(), History(query).size());
    EXPECT_EQ(Gaps(query).size(), History(query).size());
    return History(query).size();
  };
  HistoryQuery query;
  EXPECT_EQ(counts(query), 4);
  query.fleet = "f1";
  EXPECT_EQ(counts(query), 3);
  query.ruri = Robot("a")->ruri;
  EXPECT_EQ(counts(query), 2);
  EXPECT_THAT(Active(query), SizeIs(1));
  query.from = Time(20);
  EXPECT_EQ(counts(query), 1);
  query.from = Time(10);
  query.to = Time(20);
  EXPECT_EQ(counts(query), 2) << "both ends are included";
  query.to = Time(19);
  EXPECT_EQ(counts(query), 1);
  query.fleet = "f2";
  EXPECT_EQ(counts(query), 0);
  query = HistoryQuery();
  query.from = Time(31);
  EXPECT_EQ(counts(query), 1);
}

TEST_P(StoreContract, RefusesPageTokensOfOthers) {
  Open();
  Commit({Good(1, Fault("f")), Good(2, Fault("g"))});
  HistoryQuery query;
  query.page_size = 1;
  const auto page = store_->reader().FaultHistory(query);
  ASSERT_TRUE(page.ok()) << page.status();
  const std::string good = page->next_token;
  std::string changed = good;
  changed[10] = changed[10] == '0' ? '1' : '0';
  for (const std::string& token :
       {std::string("x"), std::string(good.size(), 'z'), good + "0", good.substr(1), changed,
        std::string(1, '\0'), std::string(100'000, '0'),
        storage::EncodePageToken(storage::PageKind::kGaps, {Time(), 1})}) {
    query.page_token = token;
    const absl::Status status = store_->reader().FaultHistory(query).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << token.substr(0, 100);
    EXPECT_THAT(std::string(status.message()), StartsWith("pageToken"));
  }
  query.page_token = good;
  EXPECT_THAT(History(query), SizeIs(1));
  EXPECT_EQ(store_->reader().Gaps(query).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(store_->reader().Quarantine({.rows = query}).status().code(),
            absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(store_->reader().FaultsActive(query).status().code(),
            absl::StatusCode::kInvalidArgument);
}

TEST_P(StoreContract, BoundsThePageSize) {
  HistoryQuery query;
  for (const std::uint32_t size : {0U, storage::kPageSizeMax + 1}) {
    query.page_size = size;
    const absl::Status status = store_->reader().Gaps(query).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << size;
    EXPECT_THAT(std::string(status.message()), StartsWith("pageSize"));
  }
  for (const std::uint32_t size : {1U, storage::kPageSizeMax}) {
    query.page_size = size;
    EXPECT_TRUE(store_->reader().Gaps(query).ok()) << size;
  }
}

}  // namespace
}  // namespace uplink::testing
