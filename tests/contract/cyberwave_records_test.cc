#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <gmock/gmock.h>

#include "schema/cyberwave/records.h"
#include "schema/json/text.h"
#include "storage/origin.h"
#include "tests/contract/store_contract.h"
#include "tests/unit/server/cyberwave/applying.h"

/// What Cyberwave's messages become, from the topic to the row.
namespace uplink::testing {
namespace {

using storage::OutcomeKind;
using ::testing::Each;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class CyberwaveRecordContract : public StoreContract {
 protected:
  CyberwaveRecordContract() {
    Open();
    OpenAlso({nobody_});
  }

  /// Publishes a message of the twin, stores what it makes, and opens the store anew.
  void Publish(std::string_view tail, std::string_view payload) {
    Store(twin_.Publish(tail, payload).records, payload.size());
  }
  /// The same of what is no robot.
  void PublishOfScope(std::string_view tail, std::string_view payload) {
    cyberwave::Judgement judgement = test::JudgeOn(tail, payload);
    std::optional<cyberwave::DurableRecord> made = cyberwave::Records::Take(judgement);
    ASSERT_TRUE(made) << tail;
    Store({*std::move(made)}, payload.size());
  }

  static constexpr std::string_view kNote =
      R"({"event_type":"bumped","timestamp":2,"x":{"a":null}})";

 private:
  void Store(std::vector<cyberwave::DurableRecord> made, std::size_t payload_bytes) {
    std::vector<storage::CommitRecord> records;
    records.reserve(made.size());
    for (cyberwave::DurableRecord& record : made) {
      records.push_back(RecordOf(std::move(record), payload_bytes));
    }
    ASSERT_THAT(records, Not(IsEmpty()));
    EXPECT_THAT(Commit(std::move(records)), Each(OutcomeKind::kStored));
    store_->Reopen();
  }
  storage::CommitRecord RecordOf(cyberwave::DurableRecord&& made, std::size_t bytes) {
    const bool of_nobody = std::holds_alternative<model::ScopeUpdate>(made);
    storage::CommitRecord record = Good(++seq_);
    if (of_nobody) record = Of(nobody_, std::move(record));
    std::visit(
        [&record](auto&& content) { record.content = std::forward<decltype(content)>(content); },
        std::move(made));
    if (const auto* good = std::get_if<model::Record>(&record.content)) {
      EXPECT_TRUE(good->durable());
      EXPECT_EQ(good->payload_bytes(), bytes);
    }
    return record;
  }

  test::AppliedTwin twin_;
  model::Seq seq_ = 0;
  const storage::RobotRef nobody_ =
      std::make_shared<const model::RobotId>(model::RobotId{storage::NoRobotOf(""), "f1"});
};

TEST_P(CyberwaveRecordContract, AnEventIsListedByItsTypeWithItsPayload) {
  Publish("event", kNote);
  Publish("telemetry", R"({"type":"connected"})");
  const auto rows = Events();
  ASSERT_THAT(rows, SizeIs(2));
  EXPECT_EQ(rows[0].kind, "cyberwave/connected");
  EXPECT_EQ(rows[0].detail_json, R"({"type":"connected"})");
  EXPECT_EQ(rows[0].sampled_at_ms, 0);
  EXPECT_EQ(rows[1].kind, "cyberwave/bumped");
  EXPECT_EQ(rows[1].detail_json, kNote);
  EXPECT_EQ(rows[1].sampled_at_ms, 2'000);
  EXPECT_EQ(rows[1].robot, *robot_);
}

TEST_P(CyberwaveRecordContract, ALineOfALogIsListedWithTheRestOfIt) {
  Publish("driverlog", R"({"message":"slow","level":"Warning","timestamp":1,"source":"arm ä"})");
  const auto rows = Messages();
  ASSERT_THAT(rows, SizeIs(1));
  const std::string detail = R"({"source":"arm ä","level":"Warning","timestamp":1})";
  EXPECT_EQ(rows[0].message, (model::Message{1'000, model::MessageLevel::kWarn, "slow", detail}));
}

TEST_P(CyberwaveRecordContract, ANavigationIsARun) {
  Publish("navigate/status", R"({"action_id":"a","status":"queued","progress":42.5})");
  Publish("navigate/status", R"({"action_id":"a","status":"cancelled","message":"enough"})");
  const auto runs = Runs();
  ASSERT_THAT(runs, SizeIs(1));
  EXPECT_EQ(runs[0].mission_id, "");
  EXPECT_EQ(runs[0].run_id, "a");
  EXPECT_EQ(runs[0].status, model::MissionStatus::kAborted);
  EXPECT_EQ(runs[0].updates, 2U);
  const auto reports = Reports();
  ASSERT_THAT(reports, SizeIs(2));
  EXPECT_EQ(reports[1].status, model::MissionStatus::kReady);
  EXPECT_EQ(json::NumberIn(reports[1].report_json, "progressX100"), 4'250);
  EXPECT_NE(reports[0].report_json.find("enough"), std::string::npos);
}

TEST_P(CyberwaveRecordContract, AnErrorOfMetricsIsAFaultUntilItIsNamedNoMore) {
  Publish("metrics", R"({"metrics":{"errors":["hot","low"]}})");
  Publish("metrics", R"({"metrics":{"errors":["low"]}})");
  const auto active = Active();
  ASSERT_THAT(active, SizeIs(1));
  EXPECT_EQ(active[0].fault.fault_id, "low");
  EXPECT_EQ(active[0].fault.source, "cyberwave/metrics");
  EXPECT_THAT(History(), SizeIs(3));
}

TEST_P(CyberwaveRecordContract, AnUpdateOfAScopeIsNoRobots) {
  const std::string environment = R"({"type":"weather","data":{"wind":3},"timestamp":5})";
  PublishOfScope("environment/weather", environment);
  PublishOfScope("workflow-run", R"({"status":"running"})");
  const auto rows = ScopeUpdates();
  ASSERT_THAT(rows, SizeIs(2));
  EXPECT_EQ(rows[0].update,
            (model::ScopeUpdate{model::ScopeKind::kWorkflowRun, std::string(test::kEnvironment),
                                "running", R"({"status":"running"})", 0}));
  EXPECT_EQ(rows[1].update,
            (model::ScopeUpdate{model::ScopeKind::kEnvironment, std::string(test::kEnvironment),
                                "weather", environment, 5'000}));
}

INSTANTIATE_TEST_SUITE_P(Stores, CyberwaveRecordContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
