// What a stream hears of messages over their variant's rate.
#include "schema/encode.h"
#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::string Upsert(const std::string& id) {
  model::Object object;
  object.id = id;
  return schema::Encode(model::ObjectOp{object});
}
std::string Delete(const std::string& id) {
  return schema::Encode(model::ObjectOp{model::Deletion{id}});
}
std::string Health() {
  model::SystemHealth health;
  health.device_id = "a";
  health.cpu_pct = 1.0F;
  return schema::Encode(health);
}

class RateTest : public SessionTest {
 protected:
  RateTest() {
    Set(model::Variant::kObject, {.rate = 10, .burst = 2});
    Set(model::Variant::kSystemHealth, {.rate = 1, .burst = 1});
  }
  void Set(model::Variant variant, robot::BucketSize size) {
    limits_.allowance.rates[static_cast<std::size_t>(variant)] = size;
  }
  BenchStream& Welcomed() {
    BenchStream& stream = server().Connect(SessionOf(1));
    static_cast<void>(stream.Said());
    return stream;
  }
  std::uint64_t Limited() {
    return server().counts().rejects[static_cast<std::size_t>(model::RejectReason::kRateLimited)];
  }
};

TEST_F(RateTest, WhatIsOverTheRateIsRejectedAndSettledAtOnce) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Upsert("a")}, {2, Upsert("b")}, {3, Upsert("c")}, {4, Upsert("d")}}));
  EXPECT_THAT(stream.Said(), ElementsAre("reject 3 rate_limited ", "reject 4 rate_limited "));
  EXPECT_EQ(stream.frames().back().reject().retry_after_ms(), 200);
  EXPECT_EQ(Limited(), 2U);
  EXPECT_EQ(server().counts().in_flight, 2);
  server().Commit();
  EXPECT_THAT(stream.Said(), ElementsAre("ack 4 judged 4"));
  EXPECT_THAT(Stored(1), ElementsAre(1, 2));
  EXPECT_EQ(server().counts().rejected, 2U);
  server().Pass(milliseconds(100));
  stream.Send(BatchFrame({{5, Upsert("c")}, {6, Upsert("d")}}));
  EXPECT_THAT(stream.Said(), ElementsAre("reject 6 rate_limited "));
  server().Pass(milliseconds(100));
  stream.Send(BatchFrame({{7, Upsert("d")}}));
  server().Commit();
  EXPECT_THAT(Stored(1), ElementsAre(1, 2, 5, 7));
}

TEST_F(RateTest, ALiveKindIsLimitedToo) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Health()}, {2, Health()}, {3, Motion()}}));
  EXPECT_THAT(stream.Said(), ElementsAre("reject 2 rate_limited "));
  EXPECT_EQ(server().counts().applied, 2U);
  EXPECT_EQ(server().robot().rates.limited(model::Variant::kSystemHealth), 1U);
}

TEST_F(RateTest, ADeletionAlwaysPasses) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Upsert("a")}, {2, Upsert("b")}, {3, Upsert("c")}, {4, Delete("c")}}));
  server().Commit();
  EXPECT_THAT(Stored(1), ElementsAre(1, 2, 4));
}

TEST_F(RateTest, NothingIsLimitedBeforeTheStoresCursorIsKnownNorUpToIt) {
  BenchStream& first = Welcomed();
  first.Send(BatchFrame({{1, Upsert("a")}, {2, Upsert("b")}}));
  server().Commit();
  Start();
  server().StoreAway();
  BenchStream& stream = server().Connect(SessionOf(1));
  server().Pass(kWelcomeWait);
  static_cast<void>(stream.Said());
  stream.Send(BatchFrame(
      {{1, Upsert("a")}, {2, Upsert("b")}, {3, Upsert("c")}, {4, Upsert("d")}, {5, Upsert("e")}}));
  EXPECT_EQ(Limited(), 0U) << "it may be what the store has";
  server().StoreBack();
  server().Commit();
  EXPECT_THAT(Stored(1), ElementsAre(1, 2, 3, 4, 5));
  static_cast<void>(stream.Said());
  stream.Send(BatchFrame({{6, Upsert("f")}, {7, Upsert("g")}, {8, Upsert("h")}}));
  EXPECT_THAT(stream.Said(), ElementsAre("reject 8 rate_limited "));
}

TEST_F(RateTest, TheNextWelcomeRepeatsItWithItsTimeAndItNeedNotBeConfirmed) {
  limits_.session.unconfirmed_rejects_max = 3;
  BenchStream& stream = Welcomed();
  for (model::Seq seq = 1; seq <= 10; ++seq) stream.Send(BatchFrame({{seq, Upsert("a")}}));
  EXPECT_EQ(stream.end(), "") << "limited ones are no Rejects that the store has to keep";
  EXPECT_EQ(Limited(), 8U);
  server().Commit();
  stream.Break();
  BenchStream& next = server().Connect(SessionOf(1), 8, 8);
  EXPECT_THAT(next.Said(), ElementsAre("welcome 10", "reject 9 rate_limited ",
                                       "reject 10 rate_limited ", "ack 10 judged 10"));
  EXPECT_GT(next.frames()[1].reject().retry_after_ms(), 0);
  EXPECT_EQ(server().robot().rates.limited(model::Variant::kObject), 0U) << "of this stream";
}

TEST_F(RateTest, AReloadHoldsFromTheNextFrameOn) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 4, Upsert("a"))));
  EXPECT_EQ(Limited(), 2U);
  server().allowances().Set({});
  stream.Send(BatchFrame(Messages(5, 50, Upsert("a"))));
  EXPECT_EQ(Limited(), 2U);
}

}  // namespace
}  // namespace uplink::session
