#include "server/robot/live_bytes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/base/utf8.h"
#include "schema/encode.h"
#include "schema/limits.h"
#include "tests/support/manual_clock.h"
#include "tests/support/records.h"
#include "tests/support/vector_files.h"

namespace uplink::robot {
namespace {

using storage::LivePart;
using ::testing::ElementsAre;

constexpr std::int64_t kNow = 1'763'683'200'000;

template <typename Items>
std::vector<std::string> KeysOf(const Items& items) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : items) keys.push_back(key);
  return keys;
}

class LiveBytesTest : public ::testing::Test {
 protected:
  /// What `bodies` make of a robot, written and read again.
  LiveRead Again(const std::vector<model::Body>& bodies) {
    LiveChanges changes;
    changes.changed.set();
    for (const model::Body& body : bodies) PutInto(changes.parts, model::Body(body));
    return FromRow(ToRow("rcan://a", changes), judge_);
  }
  static std::string Framed(const std::string& message) {
    std::string bytes;
    for (unsigned shift = 0; shift < 32; shift += 8) {
      bytes.push_back(static_cast<char>((message.size() >> shift) & 0xFFU));
    }
    return bytes + message;
  }
  LiveRead Read(LivePart part, const std::string& bytes) {
    storage::LiveRow row;
    row.parts[static_cast<std::size_t>(part)] = bytes;
    return FromRow(row, judge_);
  }

  schema::Judge judge_{JudgeLimitsOfLive()};
};

TEST_F(LiveBytesTest, EveryVectorComesBackAsItWas) {
  std::size_t live = 0;
  for (const std::string& name : test::VectorNames()) {
    const std::string payload = test::ReadVector(name, ".bin");
    schema::Judge judge{schema::JudgeLimits()};
    schema::Judgement judgement = judge.Payload(test::AsPayload(payload));
    model::Record record = std::get<model::Record>(std::move(judgement.verdict));
    if (record.durable()) continue;
    ++live;
    LiveChanges changes;
    changes.changed.set();
    PutInto(changes.parts, std::move(record).TakeBody());
    const storage::LiveRow row = ToRow("rcan://a", changes);
    const LiveRead read = FromRow(row, judge_);
    EXPECT_EQ(read.left_out, 0U) << name;
    EXPECT_EQ(read.before.parts.motion, changes.parts.motion) << name;
    EXPECT_EQ(read.before.parts.status, changes.parts.status) << name;
    EXPECT_EQ(read.before.parts.usage, changes.parts.usage) << name;
    EXPECT_EQ(read.before.parts.health.items(), changes.parts.health.items()) << name;
    EXPECT_EQ(read.before.parts.consumables.items(), changes.parts.consumables.items()) << name;
    EXPECT_EQ(read.before.parts.directives.items(), changes.parts.directives.items()) << name;
    EXPECT_EQ(KeysOf(read.before.parts.extras.items()), KeysOf(changes.parts.extras.items()));
    changes.parts = read.before.parts;
    EXPECT_EQ(ToRow("rcan://a", changes), row) << name;
  }
  EXPECT_EQ(live, 14U);
}

TEST_F(LiveBytesTest, KeysKeepTheirOrderValuesAndTimes) {
  const LiveRead read =
      Again({model::TelemetryExtras{
                 .unix_time_ms = kNow,
                 .kv = {{.key = "b", .value = std::string("text"), .unix_time_ms = kNow - 30},
                        {.key = "a", .value = 2.5, .unix_time_ms = {}},
                        {.key = "c", .value = std::int32_t{-7}, .unix_time_ms = {}},
                        {.key = "d", .value = true, .unix_time_ms = {}},
                        {.key = "e", .value = model::EnumName{"on"}, .unix_time_ms = {}}}},
             model::SystemHealth{.unix_time_ms = kNow, .device_id = "z", .cpu_pct = 10},
             model::SystemHealth{.unix_time_ms = kNow, .device_id = "y"},
             model::SpatialDirectiveStatus{.directive_id = "d1", .active = true}});
  EXPECT_EQ(read.left_out, 0U);
  const auto& extras = read.before.parts.extras.items();
  EXPECT_THAT(KeysOf(extras), ElementsAre("b", "a", "c", "d", "e"));
  EXPECT_EQ(extras.front().second.sampled_at_ms, kNow - 30);
  EXPECT_EQ(extras.front().second.value, model::Value(std::string("text")));
  EXPECT_EQ(std::next(extras.begin())->second.sampled_at_ms, kNow);
  EXPECT_EQ(extras.back().second.value, model::Value(model::EnumName{"on"}));
  EXPECT_THAT(KeysOf(read.before.parts.health.items()), ElementsAre("z", "y"));
  EXPECT_EQ(read.before.parts.health.items().front().second.cpu_pct, 10);
  EXPECT_TRUE(read.before.parts.directives.items().front().second.active);
}

TEST_F(LiveBytesTest, ARobotStateComesBackAsItWas) {
  LiveChanges changes;
  changes.changed.set(static_cast<std::size_t>(LivePart::kRcan));
  model::RcanState& state = changes.parts.rcan.emplace();
  state.seq = 7;
  state.battery_v = 14.2;
  state.timestamp_us = 1'741'737'600'000'000;
  state.joints.push_back({.joint = "pan \"1\"", .position_rad = 0.785, .timestamp_us = 5});
  state.seq_missing = 3;
  const LiveRead read = FromRow(ToRow("rcan://a", changes), judge_);
  EXPECT_EQ(read.left_out, 0U);
  model::RcanState expected = state;
  expected.seq_missing = 0;  // counted from each stream's begin
  EXPECT_EQ(read.before.parts.rcan, expected);
  EXPECT_FALSE(FromRow(ToRow("rcan://a", {}), judge_).before.parts.rcan);
}

/// A live message with texts of control characters, as long as they may be.
model::Body Judged(const model::Body& body) {
  model::Record record = test::RecordOf(body);
  EXPECT_TRUE(record.dropped().empty())
      << record.dropped().front().field << ": " << record.dropped().front().detail;
  return std::move(record).TakeBody();
}

TEST_F(LiveBytesTest, TextsThatGrewBeyondTheirLimitComeBackAsTheyWere) {
  const std::string id(schema::kIdBytesMax, '\x01');
  const std::string name(schema::kNameBytesMax, '\x02');
  const std::string description(schema::kDescriptionBytesMax, '\x03');
  model::StatusTelemetry status;
  status.status = description;
  status.estop = model::EStop{.unix_time_ms = 0, .active = true, .ids = {id}};
  model::FuelStatus fuel;
  fuel.level_pct = fuel.volume_remaining = fuel.capacity = fuel.efficiency = 1;
  fuel.volume_unit = name;
  status.fuel = fuel;
  model::TelemetryExtras extras;
  extras.kv.push_back({.key = id, .value = description, .unix_time_ms = {}});
  LiveChanges changes;
  changes.changed.set();
  for (const model::Body& body : std::vector<model::Body>{
           status, extras, model::SystemHealth{.unix_time_ms = kNow, .device_id = id},
           model::SpatialDirectiveStatus{.directive_id = id, .active = true}}) {
    PutInto(changes.parts, Judged(body));
  }
  const LiveRead read = FromRow(ToRow("rcan://a", changes), judge_);
  EXPECT_EQ(read.left_out, 0U);
  EXPECT_EQ(read.before.parts.status, changes.parts.status);
  EXPECT_EQ(read.before.parts.status->status->size(),
            schema::kDescriptionBytesMax * kReplacementBytes);
  EXPECT_EQ(read.before.parts.health.items(), changes.parts.health.items());
  EXPECT_EQ(read.before.parts.directives.items(), changes.parts.directives.items());
  EXPECT_EQ(KeysOf(read.before.parts.extras.items()), KeysOf(changes.parts.extras.items()));
  EXPECT_EQ(read.before.parts.extras.items().front().second.value,
            changes.parts.extras.items().front().second.value);
}

TEST_F(LiveBytesTest, WhatAnEarlierBuildKeptLosesItsControlCharacters) {
  const LiveRead read = Again({model::SystemHealth{.unix_time_ms = kNow, .device_id = "a\x01"}});
  EXPECT_EQ(read.left_out, 0U);
  EXPECT_THAT(KeysOf(read.before.parts.health.items()), ElementsAre("a\uFFFD"));
}

TEST_F(LiveBytesTest, ARobotStateThatIsNoneIsLeftOut) {
  storage::LiveRow row;
  row.ruri = "rcan://a";
  row.parts[static_cast<std::size_t>(LivePart::kRcan)] =
      Framed(R"({"ruri":"rcan://b","timestamp_us":1})") + Framed("{");
  EXPECT_EQ(FromRow(row, judge_).left_out, 2U);
}

TEST_F(LiveBytesTest, OnlyWhatChangedIsInTheRow) {
  LiveChanges changes;
  changes.changed.set(static_cast<std::size_t>(LivePart::kUsage));
  changes.parts.usage = model::UsageTelemetry{.unix_time_ms = kNow, .reboot_count = 3};
  changes.last_sign_of_life = FromUnixMs(kNow);
  changes.clock_skew_ms = -5;
  const storage::LiveRow row = ToRow("rcan://a", changes);
  EXPECT_EQ(row.ruri, "rcan://a");
  for (std::size_t kind = 0; kind < storage::kLivePartKinds; ++kind) {
    EXPECT_EQ(row.parts[kind].has_value(), kind == static_cast<std::size_t>(LivePart::kUsage));
  }
  const LiveRead read = FromRow(row, judge_);
  EXPECT_EQ(read.before.last_sign_of_life, FromUnixMs(kNow));
  EXPECT_EQ(read.before.clock_skew_ms, -5);
  EXPECT_EQ(read.before.parts.usage->reboot_count, 3U);
  EXPECT_FALSE(read.before.parts.motion);
}

TEST_F(LiveBytesTest, OfMoreThanFitsTheLatestKeysAreKept) {
  std::vector<model::Body> bodies;
  bodies.reserve(100);
  const std::string long_text(4'000, 't');
  for (int i = 0; i < 100; ++i) {
    bodies.emplace_back(model::TelemetryExtras{
        .unix_time_ms = kNow,
        .kv = {{.key = std::to_string(i), .value = long_text, .unix_time_ms = {}}}});
  }
  LiveChanges changes;
  changes.changed.set(static_cast<std::size_t>(LivePart::kExtras));
  for (const model::Body& body : bodies) PutInto(changes.parts, model::Body(body));
  const storage::LiveRow row = ToRow("rcan://a", changes);
  EXPECT_LE(storage::BytesOf(row), kLivePartBytesMax);
  const auto keys = KeysOf(FromRow(row, judge_).before.parts.extras.items());
  ASSERT_GT(keys.size(), 20U);
  EXPECT_LT(keys.size(), 100U);
  EXPECT_EQ(keys.back(), "99");
  EXPECT_EQ(keys.front(), std::to_string(100 - keys.size()));
}

TEST_F(LiveBytesTest, WhatCannotBeReadIsLeftOutAndCounted) {
  const std::string good =
      Framed(schema::Encode(model::UsageTelemetry{.unix_time_ms = kNow, .reboot_count = 1}));
  EXPECT_EQ(Read(LivePart::kUsage, good).left_out, 0U);
  EXPECT_EQ(Read(LivePart::kUsage, "").left_out, 0U);
  for (std::size_t cut = 1; cut < good.size(); ++cut) {
    const LiveRead read = Read(LivePart::kUsage, good.substr(0, cut));
    EXPECT_EQ(read.left_out, 1U) << cut;
    EXPECT_FALSE(read.before.parts.usage) << cut;
  }
  const LiveRead around = Read(LivePart::kUsage, Framed("no message") + good + Framed(""));
  EXPECT_EQ(around.left_out, 2U);
  EXPECT_TRUE(around.before.parts.usage);
  model::Message durable;
  durable.message = "hello";
  EXPECT_EQ(Read(LivePart::kMotion, Framed(schema::Encode(durable))).left_out, 1U);
  EXPECT_EQ(Read(LivePart::kMotion, std::string("\xFF\xFF\xFF\xFFx")).left_out, 1U);
}

}  // namespace
}  // namespace uplink::robot
