#include <variant>
#include <vector>

#include <gmock/gmock.h>

#include "schema/json/text.h"
#include "tests/contract/store_contract.h"
#include "tests/unit/schema/samples.h"

/// Events, messages and reports of missions.
namespace uplink::testing {
namespace {

using model::MissionStatus;
using storage::MissionsQuery;
using storage::OutcomeKind;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class ReportContract : public StoreContract {
 protected:
  static model::MissionRunStatus Report(const std::string& mission_id, const std::string& run_id,
                                        MissionStatus status = MissionStatus::kRunning) {
    model::MissionRunStatus report;
    report.mission_id = mission_id;
    report.run_id = run_id;
    report.status = status;
    return report;
  }

  static MissionsQuery Of(const std::string& mission_id, const std::string& run_id = "") {
    MissionsQuery query;
    query.mission_id = mission_id;
    query.run_id = run_id;
    return query;
  }
  static MissionsQuery OfOpen() {
    MissionsQuery query;
    query.open = true;
    return query;
  }

  template <typename Row>
  static std::vector<std::string> RunIds(const std::vector<Row>& rows) {
    std::vector<std::string> ids;
    ids.reserve(rows.size());
    for (const Row& row : rows) ids.push_back(row.run_id);
    return ids;
  }
};

TEST_P(ReportContract, KeepsAnEventWithWhatItsKindHolds) {
  struct Case {
    model::EventKind kind;
    std::string name;
    std::string detail;
  };
  const std::vector<Case> cases = {
      {model::EstopEngagedEvent{}, "estopEngaged", "{}"},
      {model::EstopReleasedEvent{}, "estopReleased", "{}"},
      {model::ModeChangedEvent{model::RobotMode::kAuto, static_cast<model::RobotMode>(77)},
       "modeChanged", R"({"from":"auto","to":"unrecognized_77"})"},
      {model::MissionStartedEvent{"m"}, "missionStarted", R"({"missionId":"m"})"},
      {model::MissionCompletedEvent{"m"}, "missionCompleted", R"({"missionId":"m"})"},
      {model::FaultRaisedEvent{"E1", "hot"}, "faultRaised",
       R"({"faultCode":"E1","description":"hot"})"},
      {model::FaultClearedEvent{"E1"}, "faultCleared", R"({"faultCode":"E1"})"},
  };
  ASSERT_EQ(cases.size() + 1, std::variant_size_v<model::EventKind>) << "and the named one";
  Open();
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto ms = static_cast<std::int64_t>(i);
    Commit({At(ms, Good(i + 1, model::EventTelemetry{kNowMs - 7 * ms, cases[i].kind}))});
  }
  const auto rows = Events();
  ASSERT_THAT(rows, SizeIs(cases.size()));
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const storage::EventRow& row = rows[cases.size() - 1 - i];
    const auto ms = static_cast<std::int64_t>(i);
    EXPECT_EQ(row.robot, *robot_);
    EXPECT_EQ(row.kind, cases[i].name);
    EXPECT_EQ(row.detail_json, cases[i].detail);
    EXPECT_EQ(row.sampled_at_ms, kNowMs - 7 * ms);
    EXPECT_EQ(row.received_at, Time(ms));
  }
}

TEST_P(ReportContract, KeepsEveryFieldOfAMessage) {
  Open();
  const model::Message unknown{0, static_cast<model::MessageLevel>(77), "x"};
  Commit({Good(1, test::SampleMessage()), At(9, Good(2, unknown))});
  const auto rows = Messages();
  ASSERT_THAT(rows, SizeIs(2));
  EXPECT_EQ(rows[0].message, unknown);
  EXPECT_EQ(rows[0].received_at, Time(9));
  EXPECT_EQ(rows[1].message, test::SampleMessage());
  EXPECT_EQ(rows[1].robot, *robot_);
  EXPECT_EQ(rows[1].received_at, Time());
}

TEST_P(ReportContract, KeepsEveryFieldOfAReportAndItsRun) {
  Open();
  const model::MissionRunStatus sample = test::SampleMission();
  Commit({Good(1, sample)});
  const auto runs = Runs();
  ASSERT_THAT(runs, SizeIs(1));
  EXPECT_EQ(runs[0].robot, *robot_);
  EXPECT_EQ(runs[0].mission_id, sample.mission_id);
  EXPECT_EQ(runs[0].run_id, sample.run_id);
  EXPECT_EQ(runs[0].name, sample.name);
  EXPECT_EQ(runs[0].status, sample.status);
  EXPECT_EQ(runs[0].latest_json, json::Text(sample));
  EXPECT_EQ(runs[0].first_received_at, Time());
  EXPECT_EQ(runs[0].last_received_at, Time());
  EXPECT_EQ(runs[0].updates, 1U);
  const auto reports = Reports();
  ASSERT_THAT(reports, SizeIs(1));
  EXPECT_EQ(reports[0].robot, *robot_);
  EXPECT_EQ(reports[0].mission_id, sample.mission_id);
  EXPECT_EQ(reports[0].run_id, sample.run_id);
  EXPECT_EQ(reports[0].status, sample.status);
  EXPECT_EQ(reports[0].report_json, json::Text(sample));
  EXPECT_EQ(reports[0].received_at, Time());
}

TEST_P(ReportContract, ShowsTheLatestReportByNumberWhateverTheRobotsClockSays) {
  Open();
  model::MissionRunStatus first = Report("m", "r", MissionStatus::kStarting);
  first.unix_time_ms = kNowMs;
  model::MissionRunStatus second = Report("m", "r", MissionStatus::kRunning);
  second.unix_time_ms = kNowMs - 3'600'000;
  model::MissionRunStatus third = Report("m", "r", MissionStatus::kPaused);
  Commit({At(10, Good(1, first))});
  Commit({At(20, Good(2, second)), At(30, Good(3, third))});
  const auto runs = Runs();
  ASSERT_THAT(runs, SizeIs(1));
  EXPECT_EQ(runs[0].status, MissionStatus::kPaused);
  EXPECT_EQ(runs[0].latest_json, json::Text(third));
  EXPECT_EQ(runs[0].first_received_at, Time(10));
  EXPECT_EQ(runs[0].last_received_at, Time(30));
  EXPECT_EQ(runs[0].updates, 3U);
  std::vector<MissionStatus> statuses;
  for (const auto& report : Reports()) statuses.push_back(report.status);
  EXPECT_THAT(statuses, ElementsAre(MissionStatus::kPaused, MissionStatus::kRunning,
                                    MissionStatus::kStarting));
}

TEST_P(ReportContract, TakesReportsOfARunThatHasEnded) {
  Open();
  const model::MissionRunStatus ended = Report("m", "r", MissionStatus::kComplete);
  const model::MissionRunStatus after = Report("m", "r", MissionStatus::kRunning);
  Commit({Good(1, ended)});
  EXPECT_THAT(Runs(OfOpen()), IsEmpty());
  Commit({At(1, Good(2, after))});
  const auto runs = Runs(OfOpen());
  ASSERT_THAT(runs, SizeIs(1));
  EXPECT_EQ(runs[0].status, MissionStatus::kRunning);
  EXPECT_EQ(runs[0].updates, 2U);
  EXPECT_THAT(Reports(), SizeIs(2));
}

TEST_P(ReportContract, KeepsTheNameThatWasGivenLast) {
  Open();
  model::MissionRunStatus named = Report("m", "r");
  named.name = "south field";
  Commit({Good(1, Report("m", "r"))});
  EXPECT_EQ(Runs().at(0).name, "");
  Commit({Good(2, named), Good(3, Report("m", "r"))});
  EXPECT_EQ(Runs().at(0).name, "south field");
  EXPECT_EQ(Runs().at(0).latest_json, json::Text(Report("m", "r")));
  named.name = "north field";
  Commit({Good(4, named)});
  EXPECT_EQ(Runs().at(0).name, "north field");
}

TEST_P(ReportContract, TellsRunsApartByRobotMissionAndRun) {
  Open();
  OpenAlso({Robot("b")});
  EXPECT_THAT(Commit({Good(1, Report("m1", "r1")), At(1, Good(2, Report("m2", "r1"))),
                      At(2, Good(3, Report("m1", "r2"))), At(3, Good(4, Report("", "r1"))),
                      At(4, StoreContract::Of(Robot("b"), Good(1, Report("m1", "r1")))),
                      At(5, Good(5, Report("m1", "r1")))}),
              Each(OutcomeKind::kStored));
  const auto runs = Runs();
  ASSERT_THAT(runs, SizeIs(5));
  EXPECT_EQ(runs[4].updates, 2U) << "the first keeps its place";
  EXPECT_EQ(runs[0].robot, *Robot("b"));
  EXPECT_THAT(RunIds(Runs(Of("m1"))), ElementsAre("r1", "r2", "r1"));
  EXPECT_THAT(RunIds(Runs(Of("m2"))), ElementsAre("r1"));
  EXPECT_THAT(Runs(Of("", "r1")), SizeIs(4));
  EXPECT_THAT(Runs(Of("m1", "r1")), SizeIs(2));
  EXPECT_THAT(Runs(Of("m2", "r2")), IsEmpty());
  EXPECT_THAT(Runs(Of("m")), IsEmpty());
  EXPECT_THAT(Reports(Of("m1")), SizeIs(4));
  EXPECT_THAT(Reports(Of("", "r1")), SizeIs(5));
  EXPECT_THAT(Reports(Of("m1", "r2")), SizeIs(1));
  MissionsQuery query = Of("m1", "r1");
  query.rows.ruris = {robot_->ruri};
  EXPECT_THAT(Runs(query), SizeIs(1));
  EXPECT_THAT(Reports(query), SizeIs(2));
  query.rows.to = Time(4);
  EXPECT_THAT(Reports(query), SizeIs(1));
}

TEST_P(ReportContract, FindsRunsByTheirFirstArrival) {
  Open();
  Commit({Good(1, Report("m", "early"))});
  Commit({At(10, Good(2, Report("m", "late"))), At(20, Good(3, Report("m", "early")))});
  EXPECT_THAT(RunIds(Runs()), ElementsAre("late", "early"));
  MissionsQuery query;
  query.rows.from = Time(10);
  EXPECT_THAT(RunIds(Runs(query)), ElementsAre("late"));
  query.rows.from = Time(11);
  EXPECT_THAT(Runs(query), IsEmpty());
  EXPECT_THAT(RunIds(Reports(query)), ElementsAre("early"));
}

TEST_P(ReportContract, KnowsWhichRunsAreOpen) {
  Open();
  std::vector<storage::CommitRecord> records;
  const std::vector<MissionStatus> statuses = {
      MissionStatus::kUnknown,       MissionStatus::kReady,    MissionStatus::kStarting,
      MissionStatus::kRunning,       MissionStatus::kPaused,   MissionStatus::kBlocked,
      MissionStatus::kAborted,       MissionStatus::kComplete, MissionStatus::kError,
      static_cast<MissionStatus>(77)};
  ASSERT_EQ(statuses.size(), model::kEnumNames<MissionStatus>.size() + 1);
  for (const MissionStatus status : statuses) {
    const model::Seq seq = records.size() + 1;
    records.push_back(Good(seq, Report("m", "r" + std::to_string(seq), status)));
  }
  Commit(std::move(records));
  EXPECT_THAT(Runs(), SizeIs(10));
  std::vector<MissionStatus> open;
  for (const auto& run : Runs(OfOpen())) open.push_back(run.status);
  EXPECT_THAT(open,
              ElementsAre(static_cast<MissionStatus>(77), MissionStatus::kBlocked,
                          MissionStatus::kPaused, MissionStatus::kRunning, MissionStatus::kStarting,
                          MissionStatus::kReady, MissionStatus::kUnknown));
  MissionsQuery query = OfOpen();
  EXPECT_THAT(Reports(query), SizeIs(10)) << "open says nothing about reports";
  query.rows.page_size = 4;
  const auto first = store_->reader().MissionRuns(query);
  ASSERT_TRUE(first.ok()) << first.status();
  query.rows.page_token = first->next_token;
  EXPECT_THAT(RunIds(Runs(query)), ElementsAre("r3", "r2", "r1"));
}

TEST_P(ReportContract, ShowsTheFleetThatARobotHadThen) {
  Open();
  Commit({Good(1, Report("m", "r1")), Good(2, Note()), Good(3, test::SampleEvent())});
  robot_ = Robot("a", "f2");
  Commit({Good(4, Report("m", "r2")), Good(5, Note()), Good(6, test::SampleEvent())});
  storage::HistoryQuery query;
  for (const std::string& fleet : {std::string("f1"), std::string("f2")}) {
    query.fleets = {fleet};
    EXPECT_THAT(Events(query), SizeIs(1));
    EXPECT_THAT(Messages(query), SizeIs(1));
    EXPECT_EQ(Messages(query).at(0).robot.fleet, fleet);
    MissionsQuery missions;
    missions.rows = query;
    EXPECT_THAT(RunIds(Runs(missions)), ElementsAre(fleet == "f1" ? "r1" : "r2"));
    EXPECT_THAT(RunIds(Reports(missions)), ElementsAre(fleet == "f1" ? "r1" : "r2"));
  }
}

INSTANTIATE_TEST_SUITE_P(Stores, ReportContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
