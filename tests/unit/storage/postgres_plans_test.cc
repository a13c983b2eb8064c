#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/postgres/pages.h"
#include "tests/unit/storage/filter_cases.h"
#include "tests/unit/storage/postgres_fixture.h"

// How PostgreSQL would run the pages of lists.
namespace uplink::storage::postgres {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class PostgresPlans : public PostgresFixture {
 protected:
  PostgresPlans() {
    Store();
    // Of empty tables it would read all rows: what counts is that it need not.
    connection_ =
        Connect("SET enable_seqscan = off; SET enable_bitmapscan = off; SET enable_sort = off;");
  }

  std::string Plan(const ListShape& shape, const HistoryQuery& query, const ListFilter& filter) {
    std::optional<PagePosition> start;
    if (!query.page_token.empty()) start = PagePosition{FromUnixMs(kNowMs), 7};
    OwnedStoreCall call = PageCall(shape, query, filter, start, 101);
    const std::string& sql = texts_.emplace_back("EXPLAIN (COSTS OFF) " + call.sql);
    const auto answer = connection_->RunOne({sql, std::move(call.parameters)}, "explain");
    EXPECT_TRUE(answer.ok()) << answer.status() << sql;
    std::string plan;
    if (!answer.ok()) return plan;
    for (const ResultRow& row : *answer) plan += std::string(row.Bytes(0)) + "\n";
    return plan;
  }

  /// As long as the connection.
  std::deque<std::string> texts_;
  std::unique_ptr<Connection> connection_;
};

TEST_F(PostgresPlans, EveryListOfRobotsOrAFleetIsReadFromAnIndex) {
  ForEachList([this]<PageKind kList>() {
    for (const HistoryQuery& query : RobotQueries()) {
      if (query.ruris.empty() && query.fleets.empty()) continue;
      const auto& merged_by = query.ruris.empty() ? query.fleets : query.ruris;
      const bool merged = merged_by.size() > 1;
      const std::string plan = Plan(List<kList>::kShape, query, {});
      EXPECT_THAT(plan, Not(HasSubstr("Seq Scan"))) << plan;
      if (!merged) {
        EXPECT_THAT(plan, Not(HasSubstr("Sort\n"))) << plan;
      }
      EXPECT_THAT(plan, HasSubstr(query.ruris.empty() ? "(fleet = " : "(ruri = ")) << plan;
      EXPECT_THAT(plan, HasSubstr("Index Cond: ")) << plan;
    }
  });
  connection_.reset();
}

TEST_F(PostgresPlans, TheAuditIsReadFromAnIndex) {
  for (const HistoryQuery& query : RobotQueries()) {
    const std::string plan = Plan(List<PageKind::kAudit>::kShape, query, {});
    EXPECT_THAT(plan, Not(HasSubstr("Seq Scan"))) << plan;
    if (query.ruris.empty() && query.fleets.empty()) continue;
    EXPECT_THAT(plan, HasSubstr(query.ruris.empty() ? "(fleet = " : "(target = ")) << plan;
  }
  connection_.reset();
}

TEST_F(PostgresPlans, EveryFilterIsAnsweredFromAnIndexAloneAndWithAFleet) {
  for (const FilterCase& one : FilterCases()) {
    for (const HistoryQuery& query : RobotQueries()) {
      SCOPED_TRACE(one.name);
      const bool of_all = query.ruris.empty();
      const std::string plan = Plan(one.shape, query, of_all ? one.filter : one.of_robots);
      EXPECT_THAT(plan, Not(HasSubstr("Seq Scan"))) << plan;
      if (query.ruris.size() <= 1) {
        EXPECT_THAT(plan, Not(HasSubstr("Sort\n"))) << plan;
      }
      EXPECT_THAT(plan, HasSubstr("Index Cond: ")) << plan;
      if (of_all) {
        EXPECT_THAT(plan,
                    ::testing::ContainsRegex("Index Cond: \\(+" + std::string(one.index) + " = "))
            << plan;
      }
    }
  }
  connection_.reset();
}

}  // namespace
}  // namespace uplink::storage::postgres
