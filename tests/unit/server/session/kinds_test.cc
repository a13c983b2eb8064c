// What becomes of good messages: stored, applied, superseded.
#include "schema/encode.h"
#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;

class KindsTest : public SessionTest {
 protected:
  KindsTest() : stream_(server().Connect(SessionOf(1))) { static_cast<void>(stream_.TakeLines()); }
  robot::LiveParts Parts() {
    return server().robot().state.Snapshot(robot::RobotState::Parts::kAll).parts;
  }
  BenchStream& stream_;
};

std::string Health(const std::string& device) {
  model::SystemHealth health;
  health.unix_time_ms = 1'763'683'200'000;
  health.device_id = device;
  return schema::Encode(health);
}

std::string ObjectThatExpires(std::int64_t at_ms) {
  model::Object object;
  object.id = "o1";
  object.name = "cone";
  object.unix_time_ms = 1'763'683'200'000;
  object.expires_unix_time_ms = at_ms;
  object.location = {.lat_deg = 47, .lon_deg = 8};
  return schema::Encode(model::ObjectOp{object});
}

std::string ShapeThatExpires(std::int64_t at_ms) {
  model::ReportedShape shape;
  shape.identity = {.id = "s1", .name = "area"};
  shape.data = model::GeoPoint2{.lon = 8, .lat = 47};
  shape.expire_time_ms = at_ms;
  return schema::Encode(model::ShapeOp{shape});
}

TEST_F(KindsTest, LiveIsAppliedAtOnce) {
  stream_.Send(BatchFrame({{1, Motion(47)}}));
  EXPECT_EQ(Parts().motion->pose->lat_deg, 47);
  EXPECT_EQ(server().counts().applied, 1U);
  EXPECT_EQ(server().robot().state.presence(), robot::Presence::kOnline);
}

TEST_F(KindsTest, TheLatestInStreamOrderWins) {
  stream_.Send(BatchFrame({{1, Motion(47)}}));
  stream_.Send(BatchFrame({{2, Motion(46)}}));
  EXPECT_EQ(Parts().motion->pose->lat_deg, 46);
  EXPECT_EQ(server().counts().applied, 2U);
}

TEST_F(KindsTest, ALaterOneOfTheSameFrameSupersedes) {
  stream_.Send(BatchFrame({{1, Motion(47)}, {2, Fault()}, {3, Motion(46)}, {4, Motion(45)}}));
  EXPECT_EQ(Parts().motion->pose->lat_deg, 45);
  EXPECT_EQ(server().counts().applied, 1U);
  EXPECT_EQ(server().counts().superseded, 2U);
}

TEST_F(KindsTest, KeyedKindsOfOneFrameAreAllApplied) {
  stream_.Send(BatchFrame({{1, Health("a")}, {2, Health("b")}, {3, Health("a")}}));
  EXPECT_EQ(Parts().health.items().size(), 2U);
  EXPECT_EQ(server().counts().applied, 3U);
  EXPECT_EQ(server().counts().superseded, 0U);
}

TEST_F(KindsTest, AnUpsertThatExpiredOnArrivalIsSuperseded) {
  const std::int64_t now = UnixMs(clock_.System());
  stream_.Send(BatchFrame({{1, ObjectThatExpires(now)}, {2, ShapeThatExpires(now)}}));
  EXPECT_EQ(server().counts().superseded, 2U);
  EXPECT_EQ(server().counts().in_flight, 0);
  server().Pass(limits_.session.ack_interval);
  EXPECT_THAT(stream_.TakeLines(), ElementsAre("ack 2 judged 2"));
}

TEST_F(KindsTest, AnUpsertThatExpiredOnArrivalIsStoredWhereNobodyVouchesForTheClock) {
  const std::int64_t now = UnixMs(clock_.System());
  server().clock_trust().Set(false);
  stream_.Send(BatchFrame({{1, ObjectThatExpires(now)}, {2, ShapeThatExpires(now)}}));
  server().Commit();
  EXPECT_EQ(server().counts().superseded, 0U);
  EXPECT_THAT(Stored(1), ElementsAre(1, 2));
  server().clock_trust().Set(true);
  stream_.Send(BatchFrame({{3, ObjectThatExpires(now)}}));
  EXPECT_EQ(server().counts().superseded, 1U);
}

TEST_F(KindsTest, AnUpsertThatExpiresLaterOrNeverIsStored) {
  const std::int64_t now = UnixMs(clock_.System());
  stream_.Send(BatchFrame({{1, ObjectThatExpires(now + 1)},
                           {2, ShapeThatExpires(now + 1)},
                           {3, ObjectThatExpires(0)},
                           {4, ShapeThatExpires(0)}}));
  server().Commit();
  EXPECT_EQ(server().counts().superseded, 0U);
  EXPECT_THAT(Stored(1), ElementsAre(1, 2, 3, 4));
}

TEST_F(KindsTest, ADeleteIsStored) {
  stream_.Send(BatchFrame({{1, schema::Encode(model::ObjectOp{model::Deletion{"o1"}})},
                           {2, schema::Encode(model::ShapeOp{model::Deletion{"s1"}})}}));
  server().Commit();
  EXPECT_EQ(server().counts().stored, 2U);
}

TEST_F(KindsTest, ARejectedMotionIsASignOfLife) {
  server().Pass(std::chrono::minutes(3));
  server().fleet().Sweep(limits_.session.session_idle);
  EXPECT_EQ(server().robot().state.presence(), robot::Presence::kOffline);
  stream_.Send(BatchFrame({{1, Motion(123)}}));
  EXPECT_THAT(stream_.TakeLines(), ElementsAre("reject 1 out_of_range pose.latDeg"));
  EXPECT_EQ(server().robot().state.presence(), robot::Presence::kOnline);
}

TEST_F(KindsTest, AFaultIsNoSignOfLife) {
  server().Pass(std::chrono::minutes(3));
  stream_.Send(BatchFrame({{1, Fault()}}));
  server().fleet().Sweep(limits_.session.session_idle);
  EXPECT_EQ(server().robot().state.presence(), robot::Presence::kOffline);
}

TEST_F(KindsTest, BytesOfAFrameAreSignsOfLifeForAMinute) {
  const auto presence_after = [this](milliseconds time) {
    for (milliseconds passed{0}; passed < time; passed += std::chrono::seconds(1)) {
      server().Pass(std::chrono::seconds(1));
      server().fleet().Sweep(limits_.session.session_idle);
    }
    return server().robot().state.presence();
  };
  ASSERT_EQ(presence_after(std::chrono::minutes(3)), robot::Presence::kOffline);
  stream_.session().OnFrameBytes();
  EXPECT_EQ(server().robot().state.presence(), robot::Presence::kOnline);
  EXPECT_EQ(presence_after(kSlowFrameMax), robot::Presence::kOffline) << "for its timeout";
  stream_.session().OnFrameBytes();
  EXPECT_EQ(server().robot().state.presence(), robot::Presence::kOnline) << "at the limit";
  EXPECT_EQ(presence_after(std::chrono::seconds(11)), robot::Presence::kOffline);
  stream_.session().OnFrameBytes();
  EXPECT_EQ(server().robot().state.presence(), robot::Presence::kOffline) << "past it";
  // Nothing of it is a sign of life itself.
  stream_.Send(BatchFrame({{1, Fault()}}));
  EXPECT_EQ(presence_after(std::chrono::seconds(1)), robot::Presence::kOffline);
  stream_.session().OnFrameBytes();
  EXPECT_EQ(server().robot().state.presence(), robot::Presence::kOnline) << "of the next frame";
}

TEST_F(KindsTest, ControlCharactersAreReplacedAndCounted) {
  model::Message message;
  message.message = "\x1B[2Jcleared\n";
  stream_.Send(BatchFrame({{1, schema::Encode(message)}, {2, Health("a\x01\u0085")}}));
  const auto health = Parts().health.items();
  ASSERT_EQ(health.size(), 1U);
  EXPECT_EQ(health.front().first, "a\uFFFD\uFFFD");
  EXPECT_EQ(server().page().odd.control_characters, 3U);
  EXPECT_EQ(server().page().odd.times_unknown, 0U);
}

TEST_F(KindsTest, GoodRecordsAreCountedByVariant) {
  stream_.Send(BatchFrame({{1, Motion()}, {2, Motion()}, {3, Fault()}, {4, BadFault()}}));
  const metrics::MessageCounts counts = server().counts();
  EXPECT_EQ(counts.records[static_cast<std::size_t>(model::Variant::kMotionTelemetry)], 2U);
  EXPECT_EQ(counts.records[static_cast<std::size_t>(model::Variant::kFault)], 1U);
}

}  // namespace
}  // namespace uplink::session
