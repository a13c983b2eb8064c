// What a stream hears of messages over their variant's rate.
#include <algorithm>
#include <set>

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
  void Set(model::Variant variant, limits::BucketSize size) {
    limits_.allowance.rates[static_cast<std::size_t>(variant)] = size;
  }
  BenchStream& Welcomed() {
    BenchStream& stream = server().Connect(SessionOf(1));
    static_cast<void>(stream.TakeLines());
    return stream;
  }
  /// Numbers that were told as limited, each once or more.
  static std::size_t RejectedOf(const BenchStream& stream) {
    std::set<std::int64_t> numbers;
    for (const v1::RelayResponse& frame : stream.frames()) {
      if (!frame.has_reject()) continue;
      EXPECT_EQ(frame.reject().reason(), v1::REJECT_REASON_RATE_LIMITED);
      numbers.insert(static_cast<std::int64_t>(frame.reject().seq()));
    }
    return numbers.size();
  }
  static model::Seq AckedOf(const BenchStream& stream) {
    model::Seq through = 0;
    for (const v1::RelayResponse& frame : stream.frames()) {
      if (frame.has_ack()) through = std::max<model::Seq>(through, frame.ack().through_seq());
    }
    return through;
  }
  std::uint64_t Limited() {
    return server().counts().rejects[static_cast<std::size_t>(model::RejectReason::kRateLimited)];
  }
};

TEST_F(RateTest, WhatIsOverTheRateIsRejectedAtOnceAndAckedOnceItsRangeIsStored) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Upsert("a")}, {2, Upsert("b")}, {3, Upsert("c")}, {4, Upsert("d")}}));
  EXPECT_THAT(stream.TakeLines(), ElementsAre("reject 3 rate_limited ", "reject 4 rate_limited "));
  EXPECT_EQ(stream.frames().back().reject().retry_after_ms(), 200);
  EXPECT_EQ(Limited(), 0U) << "they are in flight until the store has them";
  EXPECT_EQ(server().counts().in_flight, 4);
  ExpectBalanced();
  server().Commit();
  EXPECT_THAT(stream.TakeLines(), ElementsAre("ack 4 judged 4"));
  EXPECT_EQ(Limited(), 2U);
  EXPECT_THAT(Stored(1), ElementsAre(1, 2));
  EXPECT_EQ(server().counts().rejected, 2U);
  server().Pass(milliseconds(100));
  stream.Send(BatchFrame({{5, Upsert("c")}, {6, Upsert("d")}}));
  EXPECT_THAT(stream.TakeLines(), ElementsAre("reject 6 rate_limited "));
  server().Pass(milliseconds(100));
  stream.Send(BatchFrame({{7, Upsert("d")}}));
  server().Commit();
  EXPECT_THAT(Stored(1), ElementsAre(1, 2, 5, 7));
}

TEST_F(RateTest, ALiveKindIsLimitedTooAndSettledAtOnce) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Health()}, {2, Health()}, {3, Motion()}}));
  EXPECT_THAT(stream.TakeLines(), ElementsAre("reject 2 rate_limited "));
  EXPECT_EQ(Limited(), 1U);
  server().Pass(limits_.session.ack_interval);
  EXPECT_THAT(stream.TakeLines(), ElementsAre("ack 3 judged 3"));
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
  static_cast<void>(stream.TakeLines());
  stream.Send(BatchFrame(
      {{1, Upsert("a")}, {2, Upsert("b")}, {3, Upsert("c")}, {4, Upsert("d")}, {5, Upsert("e")}}));
  EXPECT_EQ(Limited(), 0U) << "it may be what the store has";
  server().StoreBack();
  server().Commit();
  EXPECT_THAT(Stored(1), ElementsAre(1, 2, 3, 4, 5));
  static_cast<void>(stream.TakeLines());
  stream.Send(BatchFrame({{6, Upsert("f")}, {7, Upsert("g")}, {8, Upsert("h")}}));
  EXPECT_THAT(stream.TakeLines(), ElementsAre("reject 8 rate_limited "));
}

TEST_F(RateTest, ALimitedLiveMessageNeedNotBeConfirmed) {
  limits_.session.unconfirmed_rejects_max = 3;
  BenchStream& stream = Welcomed();
  for (model::Seq seq = 1; seq <= 10; ++seq) stream.Send(BatchFrame({{seq, Health()}}));
  EXPECT_EQ(stream.end(), "") << "the store has none of it";
  EXPECT_EQ(Limited(), 9U);
}

TEST_F(RateTest, ALimitedDurableOneCountsAmongTheUnconfirmedRejects) {
  limits_.session.unconfirmed_rejects_max = 3;
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 4, Upsert("a"))));
  EXPECT_EQ(stream.end(), "");
  EXPECT_TRUE(stream.reading());
  stream.Send(BatchFrame(Messages(5, 9, Upsert("a"))));
  EXPECT_FALSE(stream.reading());
  server().Commit();
  EXPECT_EQ(stream.TakeLines().back(), "ack 5 judged 5");
  EXPECT_THAT(stream.end(), ::testing::StartsWith("UNAVAILABLE: 3 Rejects of this session"));
  Start();
  BenchStream& next = server().Connect(SessionOf(1));
  EXPECT_THAT(next.end(), ::testing::StartsWith("UNAVAILABLE: 3 Rejects of this session"));
  BenchStream& confirming = server().Connect(SessionOf(1), 4, 5);
  EXPECT_THAT(confirming.TakeLines(),
              ElementsAre("welcome 5", "reject 5 rate_limited ", "ack 5 judged 5"));
  EXPECT_TRUE(confirming.reading());
}

TEST_F(RateTest, AfterAKillEachOneIsToldAgainAheadOfTheAck) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 102, Upsert("a"))));
  stream.Send(BatchFrame({{103, Fault()}}));
  server().Commit();
  EXPECT_THAT(Stored(1), ElementsAre(1, 2, 103));
  Start();
  BenchStream& next = server().Connect(SessionOf(1));
  const std::vector<std::string> said = next.TakeLines();
  ASSERT_EQ(said.size(), 102U);
  EXPECT_EQ(said.front(), "welcome 103");
  for (model::Seq seq = 3; seq <= 102; ++seq) {
    EXPECT_EQ(said[seq - 2], "reject " + std::to_string(seq) + " rate_limited ");
    EXPECT_EQ(next.frames()[seq - 2].reject().retry_after_ms(), robot::kStoredRetryAfterMs);
  }
  EXPECT_EQ(said.back(), "ack 103 judged 103");
}

TEST_F(RateTest, AKillBeforeTheCommitLeavesThemToTheAgent) {
  BenchStream& stream = Welcomed();
  server().StoreAway();
  stream.Send(BatchFrame({{1, Upsert("a")}, {2, Upsert("b")}, {3, Upsert("c")}}));
  server().Commit();
  server().Pass(limits_.session.ack_interval);
  EXPECT_THAT(stream.TakeLines(), ElementsAre("reject 3 rate_limited ", "ack 0 judged 3"));
  Start();
  BenchStream& next = server().Connect(SessionOf(1));
  EXPECT_THAT(next.TakeLines(), ElementsAre("welcome 0", "ack 0 judged 0"));
}

TEST_F(RateTest, ACutWithMoreThanMemoryHasTellsThemFromTheStore) {
  constexpr model::Seq kLast = robot::kRejectsRememberedMax + 50;
  BenchStream& stream = Welcomed();
  for (model::Seq first = 1; first < kLast; first += 50) {
    stream.Send(BatchFrame(Messages(first, std::min(first + 49, kLast), Upsert("a"))));
    server().Commit();
  }
  stream.Break();
  BenchStream& next = server().Connect(SessionOf(1));
  server().Commit();
  EXPECT_EQ(RejectedOf(next), kLast - 2);
  EXPECT_EQ(next.TakeLines().back(),
            "ack " + std::to_string(kLast) + " judged " + std::to_string(kLast));
}

TEST_F(RateTest, ACutBeforeTheyAreCommittedTellsThemOnceTheyAre) {
  constexpr model::Seq kLast = robot::kRejectsRememberedMax + 50;
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Upsert("a")}, {2, Upsert("b")}}));
  server().Commit();
  server().StoreAway();
  for (model::Seq first = 3; first < kLast; first += 50) {
    stream.Send(BatchFrame(Messages(first, std::min(first + 49, kLast), Upsert("a"))));
  }
  EXPECT_EQ(server().counts().in_flight, static_cast<std::int64_t>(kLast - 2));
  stream.Break();
  BenchStream& next = server().Connect(SessionOf(1), 2, 2);
  server().Pass(kWelcomeWait);
  server().Pass(limits_.session.ack_interval);
  EXPECT_EQ(AckedOf(next), 2U) << "the first of them left memory";
  server().StoreBack();
  server().Commit();
  EXPECT_EQ(RejectedOf(next), kLast - 2);
  EXPECT_EQ(AckedOf(next), kLast);
}

TEST_F(RateTest, AFloodIsARowPerPassAndTakesFlowLikeAGap) {
  limits_.allowance.flow.records = {.rate = 1, .burst = 4};
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 2 + 2 * kCostlyPerTurn, Upsert("a"))));
  server().Commit();
  EXPECT_EQ(database_.ApplicationCount(), 4U) << "two upserts and two ranges";
  EXPECT_EQ(Limited(), 2 * kCostlyPerTurn);
  stream.Send(BatchFrame({{2 * kCostlyPerTurn + 3, Upsert("a")}}));
  EXPECT_EQ(server().counts().received, 2 + 2 * kCostlyPerTurn) << "held back";
  server().Pass(std::chrono::seconds(1));
  server().Commit();
  EXPECT_EQ(server().counts().received, 3 + 2 * kCostlyPerTurn);
}

TEST_F(RateTest, ALimitedOneDoesNotWaitForFlowOfItsPayload) {
  const std::string payload = Upsert("a");
  limits_.allowance.flow.bytes = {.rate = 1, .burst = 2 * payload.size()};
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 2, payload)));
  server().Commit();
  // The bucket of bytes is empty: another fault would wait for as many seconds as it has bytes.
  stream.Send(BatchFrame({{3, payload}, {4, payload}}));
  EXPECT_EQ(RejectedOf(stream), 2U);
  server().Commit();
  EXPECT_EQ(AckedOf(stream), 4U);
  // One that is not limited any more does wait.
  server().Pass(std::chrono::seconds(1));
  stream.Send(BatchFrame({{5, payload}}));
  EXPECT_EQ(server().counts().received, 4U);
  EXPECT_EQ(RejectedOf(stream), 2U);
}

// A row per number is stored where the numbers are apart: each takes flow of a record.
TEST_F(RateTest, ALimitedOneBehindAGapWaitsForFlowOfBoth) {
  limits_.allowance.flow.records = {.rate = 1, .burst = 3};
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Upsert("a")}, {2, Upsert("a")}, {4, Upsert("a")}}));
  EXPECT_EQ(RejectedOf(stream), 1U);
  stream.Send(BatchFrame({{5, Upsert("a")}}));
  EXPECT_EQ(RejectedOf(stream), 1U) << "the gap and the range took two";
  server().Pass(std::chrono::seconds(3));
  EXPECT_EQ(server().counts().received, 4U);
}

TEST_F(RateTest, ARangeThatAnotherProcessFencedIsSuperseded) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Upsert("a")}, {2, Upsert("b")}, {3, Upsert("c")}, {4, Upsert("d")}}));
  testing::FakeStore other(database_, storage::ProcessId{99});
  const storage::OpenRequest request{
      .robot = server().robot().id(), .session = SessionOf(1), .at = clock_.System()};
  ASSERT_TRUE(other.OpenStreams({&request, 1}).ok());
  server().Commit();
  EXPECT_EQ(server().counts().superseded, 4U);
  EXPECT_EQ(server().counts().in_flight, 0);
  EXPECT_EQ(Limited(), 0U);
  EXPECT_THAT(stream.end(), ::testing::StartsWith("ABORTED"));
}

TEST_F(RateTest, OneThatComesAgainToAServerThatDoesNotKnowItIsRejectedByTheStore) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Upsert("a")}, {2, Upsert("b")}, {3, Upsert("c")}}));
  server().Commit();
  Start();
  server().StoreAway();
  BenchStream& next = server().Connect(SessionOf(1));
  server().Pass(kWelcomeWait);
  next.Send(BatchFrame({{1, Upsert("a")}, {2, Upsert("b")}, {3, Upsert("c")}}));
  server().StoreBack();
  server().Commit();
  EXPECT_EQ(RejectedOf(next), 1U);
  EXPECT_EQ(AckedOf(next), 3U);
  EXPECT_THAT(Stored(1), ElementsAre(1, 2));
}

TEST_F(RateTest, TheNextWelcomeRepeatsItWithItsTime) {
  BenchStream& stream = Welcomed();
  for (model::Seq seq = 1; seq <= 10; ++seq) stream.Send(BatchFrame({{seq, Upsert("a")}}));
  server().Commit();
  EXPECT_EQ(Limited(), 8U);
  stream.Break();
  BenchStream& next = server().Connect(SessionOf(1), 8, 8);
  EXPECT_THAT(next.TakeLines(), ElementsAre("welcome 10", "reject 9 rate_limited ",
                                            "reject 10 rate_limited ", "ack 10 judged 10"));
  EXPECT_GT(next.frames()[1].reject().retry_after_ms(), 0);
  EXPECT_EQ(server().robot().rates.limited(model::Variant::kObject), 0U) << "of this stream";
}

TEST_F(RateTest, AReloadHoldsFromTheNextFrameOn) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 4, Upsert("a"))));
  server().Commit();
  EXPECT_EQ(Limited(), 2U);
  server().allowances().Set({});
  stream.Send(BatchFrame(Messages(5, 50, Upsert("a"))));
  EXPECT_EQ(Limited(), 2U);
}

}  // namespace
}  // namespace uplink::session
