// Robots that share shapes and objects, over real TLS, on the real program and its embedded store.
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "tests/component/uplinkd/forwarding.h"
#include "tests/component/uplinkd/uplinkd_fixture.h"
#include "tests/support/eventually.h"

namespace uplink::testing {
namespace {

using ::testing::ElementsAre;

std::string Shared(const std::string& id, const std::string& robot) {
  return id + "@" + SharingRuri(robot);
}

class ForwardingTest : public UplinkdTest {
 protected:
  void Kill() {
    process_->Signal(SIGKILL);
    ASSERT_TRUE(process_->WaitForExit());
  }
  std::unique_ptr<SharingRobot> Connect(const std::string& robot,
                                        const std::string& fleet = "north",
                                        std::uint8_t session = 1, bool declines = false) {
    CertificateSpec spec = RobotSpec(SharingRuri(robot));
    spec.organizations = {fleet};
    return std::make_unique<SharingRobot>(Channel(spec), session, declines);
  }
  void ExpectTheLaw() const {
    const std::string text = HttpGet(http_, "/metrics").body;
    double settled = SampleIn(text, "uplinkd_forwards_waiting");
    for (const char* outcome : {"written", "coalesced", "snapshot", "dropped"}) {
      settled += SampleIn(
          text, "uplinkd_forwards_settled_total{outcome=\"" + std::string(outcome) + "\"}");
    }
    EXPECT_EQ(SampleIn(text, "uplinkd_forwards_due_total"), settled) << text;
  }
};

TEST_F(ForwardingTest, AHazardReachesTheOthersWhole) {
  Serve();
  const auto a = Connect("a");
  const auto b = Connect("b");
  const auto c = Connect("c");
  for (const auto* robot : {&a, &b, &c}) ASSERT_TRUE((*robot)->ReadSnapshot());
  const model::ReportedShape reported = SharedShape("pit");
  a->Report(model::ShapeOp{reported});
  for (const auto* robot : {&b, &c}) {
    ASSERT_TRUE((*robot)->ReadUntilHolds({Shared("pit", "a")}));
    EXPECT_EQ((*robot)->OriginOf(Shared("pit", "a")), SharingRuri("a"));
    const auto& shape = std::get<nexus_command::Shape>((*robot)->At(Shared("pit", "a"))->what);
    EXPECT_EQ(shape.identity.name, reported.identity.name);
    EXPECT_EQ(shape.identity.rev, reported.identity.rev);
    EXPECT_EQ(shape.identity.hash, reported.identity.hash);
    EXPECT_EQ(shape.data, reported.data);
    EXPECT_EQ(shape.area_type, model::LayerRole::kHazard);
    EXPECT_EQ(shape.scope, model::ScopeType::kFleet);
    EXPECT_EQ(shape.min_z_m, reported.min_z_m);
    EXPECT_EQ(shape.max_z_m, reported.max_z_m);
    EXPECT_EQ(shape.level_id, reported.level_id);
  }
  b->Report(model::ObjectOp{SharedObject("dog")});
  ASSERT_TRUE(a->ReadUntilHolds({Shared("dog", "b")})) << "its own pit never comes back";
  ASSERT_TRUE(c->ReadUntilHolds({Shared("dog", "b"), Shared("pit", "a")}));
  EXPECT_EQ(std::get<model::Object>(c->At(Shared("dog", "b"))->what).radius_m, 1.5);
  ExpectTheLaw();
  EXPECT_EQ(Sample("uplinkd_forwards_due_total"), 4);
}

TEST_F(ForwardingTest, DeletionsAndNarrowedScopesTakeAway) {
  Serve();
  const auto a = Connect("a");
  const auto b = Connect("b");
  a->Report(model::ShapeOp{SharedShape("1")});
  a->Report(model::ShapeOp{SharedShape("2")});
  a->Report(model::ShapeOp{SharedShape("3", model::ScopeType::kRobot)});
  a->Report(model::ShapeOp{SharedShape("4", model::ScopeType::kUser)});
  ASSERT_TRUE(b->ReadUntilHolds({Shared("1", "a"), Shared("2", "a")}));
  a->Report(model::ShapeOp{model::Deletion{"1"}});
  ASSERT_TRUE(b->ReadUntilHolds({Shared("2", "a")}));
  a->Report(model::ShapeOp{SharedShape("2", model::ScopeType::kRobot)});
  ASSERT_TRUE(b->ReadUntilHolds({}));
  a->Report(model::ShapeOp{SharedShape("2", model::ScopeType::kWorld)});
  ASSERT_TRUE(b->ReadUntilHolds({Shared("2", "a")}));
}

TEST_F(ForwardingTest, TwoRobotsMayChooseTheSameId) {
  Serve();
  const auto a = Connect("a");
  const auto b = Connect("b");
  const auto c = Connect("c");
  a->Report(model::ShapeOp{SharedShape("same")});
  b->Report(model::ShapeOp{SharedShape("same")});
  ASSERT_TRUE(c->ReadUntilHolds({Shared("same", "a"), Shared("same", "b")}));
  a->Report(model::ShapeOp{model::Deletion{"same"}});
  ASSERT_TRUE(c->ReadUntilHolds({Shared("same", "b")}));
}

TEST_F(ForwardingTest, FleetsDoNotHearEachOther) {
  Serve();
  const auto a = Connect("a", "north");
  const auto b = Connect("b", "south");
  const auto c = Connect("c", "south");
  a->Report(model::ShapeOp{SharedShape("north's", model::ScopeType::kWorld)});
  b->Report(model::ShapeOp{SharedShape("south's")});
  ASSERT_TRUE(c->ReadUntilHolds({Shared("south's", "b")}));
  const auto late = Connect("d", "south");
  ASSERT_TRUE(late->ReadSnapshot());
  EXPECT_THAT(late->held(), ElementsAre(Shared("south's", "b")));
}

TEST_F(ForwardingTest, WhoDeclinesHearsNothing) {
  Serve();
  const auto a = Connect("a");
  const auto b = Connect("b", "north", 1, true);
  const auto c = Connect("c");
  a->Report(model::ShapeOp{SharedShape("pit")});
  ASSERT_TRUE(c->ReadUntilHolds({Shared("pit", "a")}));
  b->Report(model::ShapeOp{SharedShape("own")});
  EXPECT_FALSE(b->declined_nothing());
}

TEST_F(ForwardingTest, AfterAKillTheSnapshotComesFromTheStore) {
  Serve();
  {
    const auto a = Connect("a");
    a->Report(model::ShapeOp{SharedShape("pit")});
    a->Report(model::ObjectOp{SharedObject("dog")});
    a->Report(model::ObjectOp{SharedObject("gone")});
    a->Report(model::ObjectOp{model::Deletion{"gone"}});
  }
  Kill();
  Serve();
  // Its origin is not there, and is not in memory but by its row.
  const auto late = Connect("late");
  ASSERT_TRUE(late->ReadSnapshot());
  EXPECT_THAT(late->held(), ElementsAre(Shared("dog", "a"), Shared("pit", "a")));
}

TEST_F(ForwardingTest, WhatExpiresIsTakenAway) {
  Serve();
  const auto a = Connect("a");
  const auto b = Connect("b");
  model::ReportedShape soon = SharedShape("soon");
  soon.expire_time_ms = UnixMs(SystemClock().System()) + 1'500;
  a->Report(model::ShapeOp{soon});
  a->Report(model::ShapeOp{SharedShape("stays")});
  ASSERT_TRUE(b->ReadUntilHolds({Shared("soon", "a"), Shared("stays", "a")}));
  ASSERT_TRUE(b->ReadUntilHolds({Shared("stays", "a")}));
  const auto late = Connect("c");
  ASSERT_TRUE(late->ReadSnapshot());
  EXPECT_THAT(late->held(), ElementsAre(Shared("stays", "a")));
}

TEST_F(ForwardingTest, TenThousandItemsInOneSnapshot) {
  Serve({"UPLINKD_RATES_OBJECT=100000", "UPLINKD_RATES_OBJECT_BURST=100000"});
  const auto a = Connect("a");
  constexpr int kItems = 10'000;
  std::vector<std::string> ids;
  for (int i = 0; i < kItems; ++i) {
    a->Queue(model::ObjectOp{SharedObject(std::to_string(i))});
    ids.push_back(Shared(std::to_string(i), "a"));
  }
  ASSERT_TRUE(a->Settle());
  const auto late = Connect("late");
  ASSERT_TRUE(late->ReadUntilHolds(ids));
  ExpectTheLaw();
  EXPECT_EQ(Sample("uplinkd_forward_items"), kItems);
}

TEST_F(ForwardingTest, ARobotThatDoesNotReadEndsUpRightAndTheOthersDoNotWait) {
  Serve({"UPLINKD_RATES_OBJECT=100000", "UPLINKD_RATES_OBJECT_BURST=100000"});
  const auto slow = Connect("slow");
  ASSERT_TRUE(slow->ReadSnapshot());
  const auto a = Connect("a");
  const auto b = Connect("b");
  constexpr int kItems = 2'500;
  std::vector<std::string> ids;
  for (int i = 0; i < kItems; ++i) {
    a->Queue(model::ObjectOp{SharedObject(std::to_string(i))});
    if (i % 2 == 0) ids.push_back(Shared(std::to_string(i), "a"));
  }
  for (int i = 1; i < kItems; i += 2) a->Queue(model::ObjectOp{model::Deletion{std::to_string(i)}});
  ASSERT_TRUE(a->Settle());
  ASSERT_TRUE(b->ReadUntilHolds(ids));
  ExpectTheLaw();
  // Until now it took nothing; what it is told then is what is true then.
  ASSERT_TRUE(slow->ReadUntilHolds(ids));
  slow->Report(model::ShapeOp{SharedShape("own")});
  ExpectTheLaw();
}

TEST_F(ForwardingTest, TheMetricsAndReadinessTellOfIt) {
  Serve();
  const auto a = Connect("a");
  a->Report(model::ShapeOp{SharedShape("pit")});
  EXPECT_TRUE(Eventually([&] { return Sample("uplinkd_forward_items") == 1; }));
  EXPECT_EQ(Sample("uplinkd_forward_receivers"), 1);
  EXPECT_EQ(Sample("uplinkd_degraded{reason=\"forward\"}"), 0);
  EXPECT_EQ(Sample("uplinkd_forward_reads_of_all_total"), 1);
  EXPECT_GT(Sample("uplinkd_forward_bytes"), 0);
}

}  // namespace
}  // namespace uplink::testing
