// Rejects and Notices: when they are told, how often, and before which Acks.
#include <cmath>
#include <limits>

#include "schema/encode.h"
#include "schema/limits.h"
#include "tests/support/fake_reader.h"
#include "tests/unit/server/session/session_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::string BadReject(model::Seq seq) {
  return "reject " + std::to_string(seq) + " missing_field faultId";
}

class RejectTest : public SessionTest {
 protected:
  BenchStream& Welcomed() {
    BenchStream& stream = server().Connect(SessionOf(1));
    static_cast<void>(stream.TakeLines());
    return stream;
  }
  /// The payloads' sizes in quarantine, newest first.
  std::vector<std::size_t> PayloadsKept() {
    const auto page = testing::FakeReader(database_).Quarantine({.rows = {.page_size = 100}});
    std::vector<std::size_t> sizes;
    if (!page.ok()) return sizes;
    for (const storage::QuarantineRow& row : page->rows) sizes.push_back(row.payload.size());
    return sizes;
  }
};

TEST_F(RejectTest, IsToldAtOnceAndSettledByItsCommit) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Fault()}, {2, BadFault()}, {3, Fault()}}));
  EXPECT_THAT(stream.TakeLines(), ElementsAre(BadReject(2)));
  EXPECT_EQ(server().counts().rejected, 0U) << "in flight until its quarantine row commits";
  EXPECT_EQ(server().counts().in_flight, 3);
  server().Commit();
  EXPECT_THAT(stream.TakeLines(), ElementsAre("ack 3 judged 3"));
  EXPECT_EQ(server().counts().rejected, 1U);
  const auto reason = static_cast<std::size_t>(model::RejectReason::kMissingField);
  EXPECT_EQ(server().counts().rejects[reason], 1U);
  EXPECT_EQ(database_.QuarantineReason(kRobot, SessionOf(1), 2)->field, "faultId");
  EXPECT_THAT(Stored(1), ElementsAre(1, 3));
}

TEST_F(RejectTest, IsWrittenBeforeTheAckThatCoversIt) {
  BenchStream& stream = Welcomed();
  stream.StopReading();
  stream.Send(BatchFrame(Messages(1, 70, Motion())));
  stream.Send(BatchFrame({{71, BadFault()}, {72, BadFault()}}));
  server().Commit();
  stream.ReadAgain();
  EXPECT_THAT(stream.TakeLines(),
              ElementsAre("ack 70 judged 70", BadReject(71), BadReject(72), "ack 72 judged 72"));
}

TEST_F(RejectTest, ByTheStoreComesBeforeTheAckThatCoversIt) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, Fault()}, {2, RefusedFault()}, {3, Fault()}}));
  server().Commit();
  EXPECT_THAT(stream.TakeLines(), ElementsAre("reject 2 store_refused faultId", "ack 3 judged 3"));
  EXPECT_EQ(server().counts().stored, 2U);
  EXPECT_EQ(server().counts().rejected, 1U);
}

TEST_F(RejectTest, ByTheStoreBehindASlowReaderComesBeforeTheAck) {
  BenchStream& stream = Welcomed();
  stream.StopReading();
  stream.Send(BatchFrame(Messages(1, 64, Motion())));
  stream.Send(BatchFrame({{65, RefusedFault()}}));
  server().Commit();
  stream.ReadAgain();
  EXPECT_THAT(stream.TakeLines(), ElementsAre("ack 64 judged 64", "reject 65 store_refused faultId",
                                              "ack 65 judged 65"));
}

TEST_F(RejectTest, ByTheStoreWithoutAStreamIsToldAfterWelcome) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, RefusedFault()}}));
  stream.Break();
  server().Commit();
  EXPECT_THAT(server().Connect(SessionOf(1)).TakeLines(),
              ElementsAre("welcome 1", "reject 1 store_refused faultId", "ack 1 judged 1"));
}

TEST_F(RejectTest, OfAnEarlierProcessIsRefusedAgain) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, RefusedFault()}}));
  server().Commit();
  Start().StoreAway();
  BenchStream& resumed = server().Connect(SessionOf(1));
  server().Pass(kWelcomeWait);
  static_cast<void>(resumed.TakeLines());
  server().StoreBack();
  resumed.Send(BatchFrame({{1, RefusedFault()}}));
  server().Commit();
  EXPECT_THAT(resumed.TakeLines(), ElementsAre("reject 1 store_refused faultId", "ack 1 judged 1"));
  EXPECT_EQ(database_.TimesWritten(kRobot, SessionOf(1), 1), 1U);
}

TEST_F(RejectTest, FromMemoryIsRepeatedAfterWelcome) {
  server().StoreAway();
  BenchStream& stream = server().Connect(SessionOf(1));
  server().Pass(kWelcomeWait);
  stream.Send(BatchFrame({{1, BadFault()}, {2, Fault()}, {3, BadFault()}}));
  stream.Break();
  BenchStream& resumed = server().Connect(SessionOf(1));
  server().Pass(kWelcomeWait);
  EXPECT_THAT(resumed.TakeLines(),
              ElementsAre("welcome 0", BadReject(1), BadReject(3), "ack 0 judged 3"));
}

TEST_F(RejectTest, UpToSettledIsNotRepeated) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 3, BadFault())));
  server().Commit();
  stream.Break();
  EXPECT_THAT(server().Connect(SessionOf(1), 2, 3).TakeLines(),
              ElementsAre("welcome 3", BadReject(3), "ack 3 judged 3"));
}

TEST_F(RejectTest, FromQuarantineIsRepeatedAfterARestart) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, BadFault()}, {2, Fault()}, {3, BadFault()}}));
  server().Commit();
  Start();
  EXPECT_THAT(server().Connect(SessionOf(1)).TakeLines(),
              ElementsAre("welcome 3", BadReject(1), BadReject(3), "ack 3 judged 3"));
  EXPECT_THAT(server().Connect(SessionOf(1), 1, 3).TakeLines(),
              ElementsAre("welcome 3", BadReject(3), "ack 3 judged 3"));
}

TEST_F(RejectTest, FromQuarantineJoinsMemory) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, BadFault()}}));
  server().Commit();
  Start();
  BenchStream& second = server().Connect(SessionOf(1));
  server().StoreAway();
  second.Send(BatchFrame({{2, BadFault()}}));
  second.Break();
  BenchStream& third = server().Connect(SessionOf(1));
  server().Pass(kWelcomeWait);
  EXPECT_THAT(third.TakeLines(),
              ElementsAre("welcome 0", BadReject(1), BadReject(2), "ack 0 judged 2"));
}

TEST_F(RejectTest, MemoryHoldsTheLast256) {
  server().StoreAway();
  BenchStream& stream = server().Connect(SessionOf(1));
  server().Pass(kWelcomeWait);
  stream.Send(BatchFrame(Messages(1, 200, BadFault())));
  stream.Send(BatchFrame(Messages(201, 300, BadFault())));
  stream.Break();
  BenchStream& away = server().Connect(SessionOf(1));
  server().Pass(kWelcomeWait);
  const std::vector<std::string> said = away.TakeLines();
  ASSERT_EQ(said.size(), robot::kRejectsRememberedMax + 2);
  EXPECT_EQ(said[1], BadReject(45));
  EXPECT_EQ(said[256], BadReject(300));
  away.Break();
  server().StoreBack();
  server().Commit();
  const std::vector<std::string> all = server().Connect(SessionOf(1)).TakeLines();
  ASSERT_EQ(all.size(), 302U) << "quarantine knows those that memory has forgotten";
  EXPECT_EQ(all[1], BadReject(1));
  EXPECT_EQ(all[300], BadReject(300));
}

TEST_F(RejectTest, ContentThatIsNotTakenIsUnsupported) {
  BenchStream& stream = Welcomed();
  v1::RelayRequest frame = BatchFrame({{1, ""}});
  frame.mutable_batch()->mutable_uplinks(0)->clear_content();
  stream.Send(frame);
  ASSERT_EQ(stream.frames().size(), 3U);
  EXPECT_EQ(stream.frames()[2].reject().detail(), "the uplink has no content");
  EXPECT_THAT(stream.TakeLines(), ElementsAre("reject 1 unsupported_content "));
  server().Commit();
  EXPECT_THAT(stream.TakeLines(), ElementsAre("ack 1 judged 1"));
  EXPECT_EQ(server().counts().rejected, 1U);
}

TEST_F(RejectTest, OnePayloadASecondAndReasonIsKept) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, BadFault()}, {2, BadFault()}, {3, "garbage"}}));
  server().Pass(milliseconds(999));
  stream.Send(BatchFrame({{4, BadFault()}}));
  server().Pass(milliseconds(1));
  stream.Send(BatchFrame({{5, BadFault()}}));
  server().Commit();
  const std::size_t bytes = BadFault().size();
  EXPECT_THAT(PayloadsKept(), ::testing::UnorderedElementsAre(bytes, 0, 7, 0, bytes));
  EXPECT_EQ(database_.Log(kRobot, SessionOf(1)).quarantined.size(), 5U) << "never the row";
}

/// A motion-free live message with one invalid field.
std::string StatusWith(float soc_pct) {
  model::StatusTelemetry status;
  status.unix_time_ms = 1'763'683'200'000;
  status.battery = model::BatteryStatus{.soc_pct = soc_pct};
  return schema::Encode(status);
}

std::string ExtrasWithNan(int index) {
  model::TelemetryExtras extras;
  extras.unix_time_ms = 1'763'683'200'000;
  for (int i = 0; i <= index; ++i) {
    const double value = i == index ? std::numeric_limits<double>::quiet_NaN() : 1;
    extras.kv.push_back({.key = "k" + std::to_string(i), .value = value, .unix_time_ms = {}});
  }
  return schema::Encode(extras);
}

TEST_F(RejectTest, ADroppedFieldIsNoticedOnceASecond) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame(Messages(1, 3, StatusWith(500))));
  EXPECT_THAT(stream.TakeLines(), ElementsAre("notice 1 out_of_range battery.socPct"));
  server().Pass(milliseconds(999));
  stream.Send(BatchFrame({{4, StatusWith(500)}}));
  EXPECT_THAT(stream.TakeLines(), IsEmpty());
  server().Pass(milliseconds(1));
  EXPECT_THAT(stream.TakeLines(), ElementsAre("ack 4 judged 4"));
  stream.Send(BatchFrame({{5, StatusWith(500)}}));
  EXPECT_THAT(stream.TakeLines(), ElementsAre("notice 5 out_of_range battery.socPct"));
  EXPECT_EQ(server().robot().state.Snapshot(robot::RobotState::Parts::kNone).fields_dropped, 5);
  EXPECT_EQ(server().counts().applied, 3U);
  EXPECT_EQ(server().counts().rejected, 0U);
}

TEST_F(RejectTest, NoticesOfOneFieldIgnoreItsIndex) {
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, ExtrasWithNan(1)}, {2, ExtrasWithNan(3)}, {3, StatusWith(500)}}));
  EXPECT_THAT(stream.TakeLines(), ElementsAre("notice 1 not_finite kv[1].value",
                                              "notice 3 out_of_range battery.socPct"));
}

std::string ExtrasOfNan(std::size_t readings) {
  model::TelemetryExtras extras;
  for (std::size_t i = 0; i < readings; ++i) {
    const double value = std::numeric_limits<double>::quiet_NaN();
    extras.kv.push_back({.key = "k" + std::to_string(i), .value = value, .unix_time_ms = {}});
  }
  extras.kv.push_back({.key = "good", .value = 7.0, .unix_time_ms = {}});
  return schema::Encode(extras);
}

TEST_F(RejectTest, EveryDroppedFieldIsCountedThoughNotEveryOneIsTold) {
  constexpr std::size_t kFields = 255;
  static_assert(kFields > schema::kDroppedFieldsListedMax);
  BenchStream& stream = Welcomed();
  stream.Send(BatchFrame({{1, ExtrasOfNan(kFields)}}));
  EXPECT_THAT(stream.TakeLines(), ElementsAre("notice 1 not_finite kv[0].value"));
  const auto state = server().robot().state.Snapshot(robot::RobotState::Parts::kAll);
  EXPECT_EQ(state.fields_dropped, static_cast<std::int64_t>(kFields));
  EXPECT_EQ(state.parts.extras.items().size(), 1U) << "the good one behind them";
  const auto dropped =
      server().page().dropped[static_cast<std::size_t>(model::Variant::kTelemetryExtras)];
  EXPECT_EQ(dropped[static_cast<std::size_t>(model::RejectReason::kNotFinite)], kFields);
}

TEST_F(RejectTest, WhatLiesInQuarantineKeepsItsControlCharacters) {
  BenchStream& stream = Welcomed();
  model::Fault fault;
  fault.description = "\x1B[2J";
  const std::string payload = schema::Encode(fault);
  stream.Send(BatchFrame({{1, payload}}));
  server().Commit();
  EXPECT_THAT(stream.TakeLines(), ElementsAre(BadReject(1), "ack 1 judged 1"));
  const auto page = testing::FakeReader(database_).Quarantine({.rows = {.page_size = 100}});
  ASSERT_TRUE(page.ok() && page->rows.size() == 1);
  EXPECT_EQ(page->rows[0].payload, payload);
  EXPECT_EQ(server().page().odd.control_characters, 0U);
}

TEST_F(RejectTest, ANoticeComesBeforeTheAckThatCoversIt) {
  BenchStream& stream = Welcomed();
  std::vector<Message> messages = Messages(1, 63, Motion());
  messages.push_back({64, StatusWith(500)});
  stream.Send(BatchFrame(messages));
  EXPECT_THAT(stream.TakeLines(),
              ElementsAre("notice 64 out_of_range battery.socPct", "ack 64 judged 64"));
}

TEST_F(RejectTest, DroppedFieldsAreCountedAStream) {
  BenchStream& first = Welcomed();
  first.Send(BatchFrame({{1, StatusWith(500)}}));
  first.Break();
  Welcomed();
  EXPECT_EQ(server().robot().state.Snapshot(robot::RobotState::Parts::kNone).fields_dropped, 0);
}

}  // namespace
}  // namespace uplink::session
