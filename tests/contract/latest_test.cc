#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "schema/json/text.h"
#include "tests/contract/store_contract.h"
#include "tests/unit/schema/samples.h"

/// The kinds whose latest message is kept for each robot.
namespace uplink::testing {
namespace {

using storage::LatestKind;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class LatestContract : public StoreContract {
 protected:
  static model::AgentInfo Agent(const std::string& version) {
    return {.agent_version = version, .software_version = {}, .os_info = {}, .uptime_s = {}};
  }

  storage::Reader::LatestRows Latest(const std::vector<std::string>& ruris,
                                     storage::LatestKindSet kinds = kAllLatest) {
    auto latest = store_->reader().Latest(ruris, kinds);
    EXPECT_TRUE(latest.ok()) << latest.status();
    return latest.ok() ? *std::move(latest) : storage::Reader::LatestRows();
  }
};

TEST_P(LatestContract, KeepsOneOfEachKind) {
  Open();
  Commit({At(1, Good(1, test::SampleAgentInfo())), At(2, Good(2, test::SampleSettings())),
          At(3, Good(3, test::SampleCapabilities()))});
  const auto rows = LatestRows();
  ASSERT_THAT(rows, SizeIs(storage::kLatestKinds));
  for (const storage::LatestRow& row : rows) EXPECT_EQ(row.ruri, robot_->ruri);
  const auto row_of = [&](LatestKind kind) {
    for (const storage::LatestRow& row : rows) {
      if (row.kind == kind) return row;
    }
    ADD_FAILURE() << "no row";
    return storage::LatestRow();
  };
  EXPECT_EQ(row_of(LatestKind::kAgentInfo).body_json, json::Text(test::SampleAgentInfo()));
  EXPECT_EQ(row_of(LatestKind::kAgentInfo).received_at, Time(1));
  EXPECT_EQ(row_of(LatestKind::kSettings).body_json, json::Text(test::SampleSettings()));
  EXPECT_EQ(row_of(LatestKind::kSettings).received_at, Time(2));
  EXPECT_EQ(row_of(LatestKind::kUiCapabilities).body_json, json::Text(test::SampleCapabilities()));
  EXPECT_EQ(row_of(LatestKind::kUiCapabilities).received_at, Time(3));
}

TEST_P(LatestContract, ReplacesInCommitOrder) {
  Open();
  model::CurrentSettings settings{{{"speed", 1.5}, {"old", true}}};
  Commit({Good(1, Agent("1")), Good(2, Agent("2")), Good(3, settings)});
  settings = {{{"speed", 2.5}}};
  Commit({At(-5, Good(4, settings)), At(-6, Good(5, Agent("0")))});
  const auto rows = LatestRows();
  ASSERT_THAT(rows, SizeIs(2));
  EXPECT_EQ(Latest({robot_->ruri}, BitOf(LatestKind::kAgentInfo)).rows.at(0).body_json,
            json::Text(Agent("0")));
  const auto latest = Latest({robot_->ruri}, BitOf(LatestKind::kSettings)).rows.at(0);
  EXPECT_EQ(latest.body_json, json::Text(settings)) << "nothing of the older ones is left";
  EXPECT_EQ(latest.received_at, Time(-5));
}

TEST_P(LatestContract, KeepsEmptyOnes) {
  Open();
  Commit({Good(1, model::UiCapabilities{}), Good(2, model::CurrentSettings{})});
  EXPECT_THAT(LatestRows(), SizeIs(2));
  EXPECT_EQ(Latest({robot_->ruri}, BitOf(LatestKind::kSettings)).rows.at(0).body_json, "{}");
}

TEST_P(LatestContract, AnswersForSomeRobotsAndKinds) {
  Open();
  const auto robot_b = Robot("b");
  OpenAlso({robot_b, Robot("c")});
  Commit({Good(1, Agent("a")), Good(2, test::SampleSettings()), Of(robot_b, Good(1, Agent("b"))),
          Of(robot_b, Good(2, test::SampleCapabilities())), Of(Robot("c"), Good(1, Agent("c")))});
  const auto agents_of = [&](const std::vector<std::string>& ruris) {
    const auto latest = Latest(ruris, BitOf(LatestKind::kAgentInfo));
    EXPECT_EQ(latest.complete, ruris.size());
    std::vector<std::string> bodies;
    for (const auto& row : latest.rows) bodies.push_back(row.body_json);
    return bodies;
  };
  const std::string a = robot_->ruri;
  const std::string b = robot_b->ruri;
  EXPECT_THAT(agents_of({a, b}), ElementsAre(json::Text(Agent("a")), json::Text(Agent("b"))));
  EXPECT_THAT(agents_of({b, "rcan://robots/none", a}),
              ElementsAre(json::Text(Agent("b")), json::Text(Agent("a"))));
  EXPECT_THAT(agents_of({"rcan://robots/none"}), IsEmpty());
  EXPECT_THAT(agents_of({}), IsEmpty());
  EXPECT_THAT(
      Latest({a, b}, BitOf(LatestKind::kAgentInfo) | BitOf(LatestKind::kUiCapabilities)).rows,
      SizeIs(3));
  EXPECT_THAT(Latest({a, b}).rows, SizeIs(4));
  const auto none = Latest({a, b}, 0);
  EXPECT_THAT(none.rows, IsEmpty());
  EXPECT_EQ(none.complete, 2U);
}

TEST_P(LatestContract, AnswersForAThousandRobots) {
  std::vector<storage::CommitRecord> records;
  std::vector<std::string> ruris;
  const model::Record good = test::RecordOf(Agent("1"));
  Open();
  std::vector<storage::RobotRef> robots;
  robots.reserve(1'000);
  for (int i = 0; i < 1'000; ++i) robots.push_back(Robot("r" + std::to_string(i)));
  OpenAlso(robots);
  for (const storage::RobotRef& robot : robots) {
    records.push_back(Of(robot, With(1, good)));
    ruris.push_back(robot->ruri);
  }
  Commit(std::move(records));
  const auto latest = Latest(ruris);
  ASSERT_THAT(latest.rows, SizeIs(1'000));
  EXPECT_EQ(latest.complete, 1'000U);
  for (std::size_t i = 0; i < ruris.size(); ++i) EXPECT_EQ(latest.rows[i].ruri, ruris[i]);
}

TEST_P(LatestContract, TellsAnOpeningOfWhichKindsItHasOne) {
  EXPECT_EQ(Open().latest_kinds, 0U);
  Commit({Good(1, Agent("1")), Good(2, Fault("f"))});
  EXPECT_EQ(Open().latest_kinds, BitOf(LatestKind::kAgentInfo));
  Commit({Good(3, test::SampleSettings()), Good(4, test::SampleCapabilities())});
  storage::OpenRequest other_robot = Request();
  other_robot.robot = Robot("b");
  const std::vector<storage::OpenRequest> requests = {Request(), other_robot, Request()};
  const auto results = store_->Process(kProcess).OpenStreams(requests);
  ASSERT_TRUE(results.ok()) << results.status();
  ASSERT_THAT(*results, SizeIs(3));
  EXPECT_EQ((*results)[0].latest_kinds, kAllLatest);
  EXPECT_EQ((*results)[1].latest_kinds, 0U) << "what is there is another robot's";
  EXPECT_EQ((*results)[2].latest_kinds, kAllLatest);
  store_->Reopen();
  storage::OpenRequest other_session = Request();
  other_session.session = Session(2);
  EXPECT_EQ(Open(other_session, kOther).latest_kinds, kAllLatest) << "from any process";
}

TEST_P(LatestContract, HoldsAfterAReopening) {
  Open();
  Commit({Good(1, Agent("1"))});
  store_->Reopen();
  ASSERT_THAT(LatestRows(), SizeIs(1));
  EXPECT_EQ(LatestRows().at(0).body_json, json::Text(Agent("1")));
}

INSTANTIATE_TEST_SUITE_P(Stores, LatestContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
