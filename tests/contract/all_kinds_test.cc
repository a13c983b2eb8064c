#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "schema/base/utf8.h"
#include "schema/json/text.h"
#include "schema/limits.h"
#include "tests/contract/store_contract.h"
#include "tests/unit/schema/samples.h"

/// All durable kinds in one batch: written once, whatever becomes of the call; and their texts.
namespace uplink::testing {
namespace {

using storage::OutcomeKind;
using ::testing::Each;
using ::testing::Ne;
using ::testing::SizeIs;

class AllKindsContract : public StoreContract {
 protected:
  /// Two of every kind, a deletion of each set, bad ones between, a gap and presence changes.
  storage::Batch Mixed() const {
    storage::Batch batch;
    model::Seq seq = 0;
    for (const char* id : {"1", "2"}) {
      for (const model::Body& body : test::SampleBodies()) {
        if (!model::IsDurable(model::VariantOf(body))) continue;
        batch.records.push_back(Good(++seq, Named(body, id)));
      }
      batch.records.push_back(Bad(++seq));
    }
    batch.records.push_back(Good(++seq, model::ShapeOp{model::Deletion{"2"}}));
    batch.records.push_back(Good(++seq, model::ObjectOp{model::Deletion{"2"}}));
    batch.gaps = {Gap(seq + 1, seq + 2)};
    batch.presence = {{robot_, model::Presence::kOnline, Time(), 1, held_since_},
                      {robot_, model::Presence::kOffline, Time(), 2, held_since_}};
    batch.presence_session = Session(99);
    return batch;
  }
  static model::Body Named(model::Body body, const std::string& id) {
    if (auto* shape = std::get_if<model::ShapeOp>(&body)) {
      std::get<model::ReportedShape>(shape->op).identity.id = id;
    } else if (auto* object = std::get_if<model::ObjectOp>(&body)) {
      std::get<model::Object>(object->op).id = id;
    }
    return body;
  }

  void ExpectMixedOnce() {
    EXPECT_THAT(History(), SizeIs(2));
    EXPECT_THAT(Active(), SizeIs(1));
    EXPECT_THAT(Events(), SizeIs(2));
    EXPECT_THAT(Messages(), SizeIs(2));
    EXPECT_THAT(Reports(), SizeIs(2));
    ASSERT_THAT(Runs(), SizeIs(1));
    EXPECT_EQ(Runs()[0].updates, 2U);
    EXPECT_THAT(Shapes(), SizeIs(1));
    EXPECT_THAT(Objects(), SizeIs(1));
    EXPECT_THAT(LatestRows(), SizeIs(storage::kLatestKinds));
    EXPECT_THAT(Quarantine(), SizeIs(2));
    EXPECT_THAT(Gaps(), SizeIs(1));
    EXPECT_THAT(Changes(), SizeIs(2));
  }
  void ExpectNothing() {
    EXPECT_THAT(History(), SizeIs(0));
    EXPECT_THAT(Active(), SizeIs(0));
    EXPECT_THAT(Events(), SizeIs(0));
    EXPECT_THAT(Messages(), SizeIs(0));
    EXPECT_THAT(Reports(), SizeIs(0));
    EXPECT_THAT(Runs(), SizeIs(0));
    EXPECT_THAT(Shapes(), SizeIs(0));
    EXPECT_THAT(Objects(), SizeIs(0));
    EXPECT_THAT(LatestRows(), SizeIs(0));
    EXPECT_THAT(Quarantine(), SizeIs(0));
    EXPECT_THAT(Gaps(), SizeIs(0));
    EXPECT_THAT(Changes(), SizeIs(0));
  }

  /// A text of exactly so many bytes that makes trouble where it is not quoted.
  static std::string Odd(std::size_t bytes) {
    std::string text = "' \" \\ ; -- %s \xF0\x9F\xA4\x96 \t\n\uFFFD {} \\u0000 \xE2\x80\xAE";
    text.resize(bytes, 'x');
    return text;
  }
};

TEST_P(AllKindsContract, AreWrittenOnce) {
  Open();
  const storage::Batch batch = Mixed();
  EXPECT_THAT(KindsOf(Commit(batch)), Each(OutcomeKind::kStored));
  ExpectMixedOnce();
  EXPECT_EQ(CursorNow(), batch.records.size());
  EXPECT_THAT(KindsOf(Commit(batch)), Each(Ne(OutcomeKind::kStored)));
  ExpectMixedOnce();
  store_->Reopen();
  EXPECT_THAT(KindsOf(Commit(batch)), Each(Ne(OutcomeKind::kStored)));
  ExpectMixedOnce();
}

TEST_P(AllKindsContract, AreWrittenOnceThoughTheAnswerIsLost) {
  Open();
  const storage::Batch batch = Mixed();
  store_->LoseNextAnswer(kProcess);
  EXPECT_FALSE(store_->Process(kProcess).Commit(batch).ok());
  ExpectMixedOnce();
  Commit(batch);
  ExpectMixedOnce();
}

TEST_P(AllKindsContract, LeaveNothingOfACommitThatFails) {
  Open();
  const storage::Batch batch = Mixed();
  store_->FailNextWrite(kProcess);
  EXPECT_EQ(store_->Process(kProcess).Commit(batch).status().code(),
            absl::StatusCode::kUnavailable);
  ExpectNothing();
  EXPECT_THAT(KindsOf(Commit(batch)), Each(OutcomeKind::kStored));
  ExpectMixedOnce();
}

TEST_P(AllKindsContract, LeaveNothingOfAHoldThatHasPassed) {
  Open();
  storage::Batch batch = Mixed();
  Open(Request(), kOther);
  EXPECT_THAT(KindsOf(Commit(batch)), Each(OutcomeKind::kFenced));
  ExpectNothing();
}

TEST_P(AllKindsContract, AreKeptBesideOneThatTheDatabaseRefuses) {
  Open();
  store_->RefuseFault("poison");
  storage::Batch batch = Mixed();
  const model::Seq poisoned = batch.records.size() + 1;
  batch.records.push_back(Good(poisoned, Fault("poison")));
  const std::vector<storage::Outcome> outcomes = Commit(batch);
  ASSERT_THAT(outcomes, SizeIs(poisoned + batch.presence.size()));
  EXPECT_EQ(outcomes[poisoned - 1].kind, OutcomeKind::kRefused);
  EXPECT_THAT(Quarantine(), SizeIs(3));
  EXPECT_THAT(Events(), SizeIs(2));
  EXPECT_EQ(Runs().at(0).updates, 2U);
  EXPECT_THAT(Shapes(), SizeIs(1));
  EXPECT_THAT(Objects(), SizeIs(1));
  EXPECT_THAT(LatestRows(), SizeIs(storage::kLatestKinds));
  EXPECT_THAT(Changes(), SizeIs(2));
}

TEST_P(AllKindsContract, KeepTextsThatGrewBeyondTheirLimit) {
  Open();
  const std::string id(schema::kIdBytesMax, '\x01');
  const std::string name(schema::kNameBytesMax, '\x01');
  model::MissionRunStatus report = test::SampleMission();
  report.mission_id = id;
  report.run_id = id;
  model::ReportedShape shape = test::SampleShape();
  shape.identity = {id, name, 1, id};
  model::Object object = test::SampleObject();
  object.id = id;
  model::Fault fault = Fault(id);
  fault.source = name;
  EXPECT_THAT(Commit({Good(1, report), Good(2, model::ShapeOp{shape}),
                      Good(3, model::ObjectOp{object}), Good(4, fault)}),
              Each(OutcomeKind::kStored));
  const std::string kept = ReplaceControls(id, id.size());
  ASSERT_THAT(Runs(), SizeIs(1));
  EXPECT_EQ(Runs()[0].run_id, kept);
  ASSERT_THAT(Shapes(), SizeIs(1));
  EXPECT_EQ(Shapes()[0].identity.id, kept);
  ASSERT_THAT(Objects(), SizeIs(1));
  ASSERT_THAT(Active(), SizeIs(1));
  EXPECT_EQ(Active()[0].fault.source, ReplaceControls(name, name.size()));

  fault.active = false;
  Commit({Good(5, model::ShapeOp{model::Deletion{id}}),
          Good(6, model::ObjectOp{model::Deletion{id}}), Good(7, fault)});
  EXPECT_THAT(Shapes(), SizeIs(0));
  EXPECT_THAT(Objects(), SizeIs(0));
  EXPECT_THAT(Active(), SizeIs(0));
}

TEST_P(AllKindsContract, KeepTheLongestAndOddestTexts) {
  const std::string id = Odd(schema::kIdBytesMax);
  const std::string name = Odd(schema::kNameBytesMax);
  const std::string description = Odd(schema::kDescriptionBytesMax);
  const std::string message = Odd(schema::kMessageTextBytesMax);
  robot_ = Robot(Odd(model::kRuriBytesMax - std::string("rcan://robots/").size()), name);
  Open();

  const model::EventTelemetry event{0, model::FaultRaisedEvent{id, description}};
  model::MissionRunStatus report = test::SampleMission();
  report.mission_id = id;
  report.run_id = id;
  report.status_message = description;
  report.current_path_id = id;
  report.name = name;
  model::ReportedShape shape = test::SampleShape();
  shape.identity = {id, name, 1, id};
  model::Object object = test::SampleObject();
  object.id = id;
  object.name = name;
  const model::CurrentSettings settings{
      {{id, description}, {id.substr(1), model::EnumName{description}}}};
  model::UiCapabilities capabilities = test::SampleCapabilities();
  capabilities.services[0].name = name;
  capabilities.services[0].description = description;
  const model::AgentInfo agent{name, name, name, 1};
  model::Fault fault = Fault(id);
  fault.source = name;
  fault.category = name;
  fault.description = description;
  fault.suggested_action = description;
  EXPECT_THAT(
      Commit({Good(1, event), Good(2, model::Message{0, model::MessageLevel::kInfo, message}),
              Good(3, report), Good(4, model::ShapeOp{shape}), Good(5, model::ObjectOp{object}),
              Good(6, settings), Good(7, capabilities), Good(8, agent), Good(9, fault)}),
      Each(OutcomeKind::kStored));
  storage::Batch batch;
  batch.presence = {{robot_, model::Presence::kOnline, Time(), 1, held_since_}};
  Commit(batch);

  storage::MissionsQuery query;
  query.rows.ruris = {robot_->ruri};
  query.rows.fleets = {name};
  query.mission_id = id;
  query.run_id = id;
  ASSERT_THAT(Events(query.rows), SizeIs(1));
  EXPECT_EQ(Events()[0].robot, *robot_);
  EXPECT_EQ(Events()[0].detail_json, json::DetailText(event.kind));
  ASSERT_THAT(Messages(query.rows), SizeIs(1));
  EXPECT_EQ(Messages()[0].message.message, message);
  ASSERT_THAT(Runs(query), SizeIs(1));
  EXPECT_EQ(Runs()[0].mission_id, id);
  EXPECT_EQ(Runs()[0].run_id, id);
  EXPECT_EQ(Runs()[0].name, name);
  EXPECT_EQ(Runs()[0].latest_json, json::Text(report));
  ASSERT_THAT(Reports(query), SizeIs(1));
  EXPECT_EQ(Reports()[0].report_json, json::Text(report));
  ASSERT_THAT(Shapes(), SizeIs(1));
  EXPECT_EQ(Shapes()[0].identity, shape.identity);
  ASSERT_THAT(Objects(), SizeIs(1));
  EXPECT_EQ(Objects()[0].id, id);
  EXPECT_EQ(Objects()[0].name, name);
  const auto latest = LatestRows();
  ASSERT_THAT(latest, SizeIs(3));
  for (const storage::LatestRow& row : latest) {
    const std::string expected = row.kind == storage::LatestKind::kAgentInfo ? json::Text(agent)
                                 : row.kind == storage::LatestKind::kSettings
                                     ? json::Text(settings)
                                     : json::Text(capabilities);
    EXPECT_EQ(row.body_json, expected);
  }
  ASSERT_THAT(Active(query.rows), SizeIs(1));
  EXPECT_EQ(Active()[0].fault, fault);
  ASSERT_THAT(History(query.rows), SizeIs(1));
  EXPECT_EQ(History()[0].fault, fault);
  EXPECT_EQ(History()[0].robot, *robot_);
  ASSERT_THAT(Changes(query.rows), SizeIs(1));
  EXPECT_EQ(Changes()[0].robot, *robot_);
  query.run_id.back() = 'y';
  EXPECT_THAT(Runs(query), SizeIs(0));

  Commit({Good(10, model::ShapeOp{model::Deletion{id}}),
          Good(11, model::ObjectOp{model::Deletion{id}})});
  EXPECT_THAT(Shapes(), SizeIs(0));
  EXPECT_THAT(Objects(), SizeIs(0));
}

INSTANTIATE_TEST_SUITE_P(Stores, AllKindsContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
