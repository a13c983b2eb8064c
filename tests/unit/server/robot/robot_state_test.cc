#include "server/robot/robot_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"
#include "tests/support/records.h"

namespace uplink::robot {
namespace {

using storage::LivePart;
using ::testing::ElementsAre;

constexpr std::int64_t kNow = 1'763'683'200'000;

std::size_t KeysMax(LivePart part) { return storage::RowOf(part).keys_max; }

class RobotStateTest : public ::testing::Test {
 protected:
  void Apply(const std::vector<model::Body>& bodies) {
    std::vector<model::Record> records;
    records.reserve(bodies.size());
    for (const model::Body& body : bodies) records.push_back(test::RecordOf(body));
    state_.Apply(records, {});
  }
  /// A batch arrives whose agent's clock is ahead by so much.
  void NoteSkew(std::int64_t ahead_ms) {
    state_.NoteBatch({.sent_unix_ms = UnixMs(clock_.System()) + ahead_ms}, clock_.Steady(),
                     clock_.System());
  }
  StateSnapshot All() const { return state_.Snapshot(RobotState::Parts::kAll); }

  testing::ManualClock clock_;
  const PresenceLimits limits_{};
  RobotState state_{clock_.Steady(), clock_.Steady(), clock_.System()};
};

model::TelemetryExtras Extras(std::vector<model::SensorReading> readings) {
  return {.unix_time_ms = kNow, .kv = std::move(readings)};
}

template <typename Items>
std::vector<std::string> KeysOf(const Items& items) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : items) keys.push_back(key);
  return keys;
}

TEST_F(RobotStateTest, BeginsWithNothing) {
  const StateSnapshot snapshot = All();
  EXPECT_FALSE(snapshot.parts.motion);
  EXPECT_FALSE(snapshot.parts.status);
  EXPECT_FALSE(snapshot.parts.usage);
  EXPECT_EQ(snapshot.presence, Presence::kUnknown);
  EXPECT_EQ(snapshot.presence_since, clock_.System());
  EXPECT_FALSE(snapshot.last_sign_of_life);
  EXPECT_FALSE(snapshot.clock_skew_ms);
  EXPECT_FALSE(snapshot.backlog);
}

TEST_F(RobotStateTest, MotionStatusAndUsageAreReplacedWhole) {
  Apply({model::MotionTelemetry{.unix_time_ms = kNow, .velocity = model::VelTwist{1, 0}},
         model::StatusTelemetry{.unix_time_ms = kNow, .status = "first"},
         model::UsageTelemetry{.unix_time_ms = kNow, .reboot_count = 1}});
  Apply({model::MotionTelemetry{.unix_time_ms = kNow - 5},
         model::StatusTelemetry{.unix_time_ms = kNow - 5, .status = "second"},
         model::UsageTelemetry{.unix_time_ms = kNow - 5, .reboot_count = 2}});
  const LiveParts parts = All().parts;
  EXPECT_EQ(parts.motion->unix_time_ms, kNow - 5) << "no robot clock decides anything";
  EXPECT_FALSE(parts.motion->velocity);
  EXPECT_EQ(parts.status->status, "second");
  EXPECT_EQ(parts.usage->reboot_count, 2U);
}

TEST_F(RobotStateTest, ExtrasAreKeptByKeyWithTheirOwnTime) {
  Apply({Extras({{.key = "rpm", .value = 1.0, .unix_time_ms = kNow - 30},
                 {.key = "temp", .value = 2.0, .unix_time_ms = {}}}),
         Extras({{.key = "rpm", .value = 3.0, .unix_time_ms = {}}})});
  const LiveParts parts = All().parts;
  const auto& items = parts.extras.items();
  EXPECT_THAT(KeysOf(items), ElementsAre("temp", "rpm"));
  EXPECT_EQ(items.front().second.sampled_at_ms, kNow);
  EXPECT_EQ(items.back().second.value, model::Value(3.0));
  EXPECT_EQ(items.back().second.sampled_at_ms, kNow);
}

TEST_F(RobotStateTest, AReadingsOwnTimeWins) {
  Apply({Extras({{.key = "rpm", .value = 1.0, .unix_time_ms = kNow - 30}})});
  EXPECT_EQ(All().parts.extras.items().front().second.sampled_at_ms, kNow - 30);
}

TEST_F(RobotStateTest, HealthConsumablesAndDirectivesAreKeptByKey) {
  Apply({model::SystemHealth{.unix_time_ms = kNow, .device_id = "main", .cpu_pct = 10},
         model::SystemHealth{.unix_time_ms = kNow, .device_id = "arm", .cpu_pct = 20},
         model::SystemHealth{.unix_time_ms = kNow, .device_id = "main", .cpu_pct = 30}});
  model::ConsumableStatus left{.unix_time_ms = kNow,
                               .kind = "paint",
                               .tank_id = "left",
                               .level_pct = 50,
                               .amount_remaining = 5,
                               .unit = "l"};
  model::ConsumableStatus right = left;
  right.tank_id = "right";
  Apply({left, right, left});
  Apply({model::SpatialDirectiveStatus{.directive_id = "d1", .active = true},
         model::SpatialDirectiveStatus{.directive_id = "d1", .active = false}});
  const LiveParts parts = All().parts;
  EXPECT_THAT(KeysOf(parts.health.items()), ElementsAre("arm", "main"));
  EXPECT_EQ(parts.health.items().back().second.cpu_pct, 30);
  EXPECT_THAT(KeysOf(parts.consumables.items()), ElementsAre("paint/right", "paint/left"));
  EXPECT_THAT(KeysOf(parts.directives.items()), ElementsAre("d1"));
  EXPECT_FALSE(parts.directives.items().front().second.active);
}

TEST_F(RobotStateTest, AtTheBoundNoKeyGoes) {
  for (std::size_t i = 0; i < KeysMax(LivePart::kHealth); ++i) {
    Apply({model::SystemHealth{.unix_time_ms = kNow, .device_id = std::to_string(i)}});
  }
  EXPECT_EQ(All().keys_evicted, 0U);
  EXPECT_EQ(All().parts.health.items().size(), KeysMax(LivePart::kHealth));
}

TEST_F(RobotStateTest, PastTheBoundTheLeastRecentlyUpdatedKeyGoes) {
  for (std::size_t i = 0; i < KeysMax(LivePart::kHealth); ++i) {
    Apply({model::SystemHealth{.unix_time_ms = kNow, .device_id = std::to_string(i)}});
  }
  Apply({model::SystemHealth{.unix_time_ms = kNow, .device_id = "0"},
         model::SystemHealth{.unix_time_ms = kNow, .device_id = "new"}});
  const StateSnapshot snapshot = All();
  EXPECT_EQ(snapshot.keys_evicted, 1U);
  const std::vector<std::string> keys = KeysOf(snapshot.parts.health.items());
  EXPECT_EQ(keys.size(), KeysMax(LivePart::kHealth));
  EXPECT_THAT(keys, ::testing::Not(::testing::Contains("1")));
  EXPECT_THAT(keys, ::testing::Contains("0"));
}

TEST_F(RobotStateTest, EveryKeyedKindHasItsBound) {
  LatestByKey<int, 2> latest;
  EXPECT_EQ(latest.Put("a", 1), 0U);
  EXPECT_EQ(latest.Put("b", 2), 0U);
  EXPECT_EQ(latest.Put("a", 3), 0U);
  EXPECT_EQ(latest.Put("c", 4), 1U);
  EXPECT_THAT(KeysOf(latest.items()), ElementsAre("a", "c"));
  for (std::size_t i = 0; i <= KeysMax(LivePart::kConsumables); ++i) {
    Apply({model::ConsumableStatus{.unix_time_ms = kNow,
                                   .kind = std::to_string(i),
                                   .tank_id = "t",
                                   .level_pct = 1,
                                   .amount_remaining = 1,
                                   .unit = "l"}});
  }
  EXPECT_EQ(All().parts.consumables.items().size(), KeysMax(LivePart::kConsumables));
  for (std::size_t i = 0; i <= KeysMax(LivePart::kDirectives); ++i) {
    Apply({model::SpatialDirectiveStatus{.directive_id = std::to_string(i)}});
    Apply({Extras({{.key = std::to_string(i), .value = 1.0, .unix_time_ms = {}}})});
  }
  EXPECT_EQ(All().parts.directives.items().size(), KeysMax(LivePart::kDirectives));
  EXPECT_EQ(All().parts.extras.items().size(), KeysMax(LivePart::kExtras));
  EXPECT_EQ(All().keys_evicted, 3U);
}

TEST_F(RobotStateTest, ACopyKeepsItsOwnKeys) {
  LatestByKey<int, 2> original;
  original.Put("a", 1);
  LatestByKey<int, 2> copy(original);
  copy.Put("a", 2);
  copy.Put("b", 3);
  original.Put("c", 4);
  EXPECT_THAT(KeysOf(copy.items()), ElementsAre("a", "b"));
  EXPECT_THAT(KeysOf(original.items()), ElementsAre("a", "c"));
  copy = original;
  copy.Put("a", 9);
  EXPECT_THAT(KeysOf(copy.items()), ElementsAre("c", "a"));
  EXPECT_EQ(original.items().front().second, 1);
}

TEST_F(RobotStateTest, ASnapshotWithoutPartsLeavesThemEmpty) {
  Apply({model::MotionTelemetry{.unix_time_ms = kNow}});
  EXPECT_FALSE(state_.Snapshot(RobotState::Parts::kNone).parts.motion);
  EXPECT_TRUE(All().parts.motion);
}

TEST_F(RobotStateTest, PresenceSinceMovesWithPresenceAlone) {
  clock_.Advance(milliseconds(100));
  state_.SignOfLife(clock_.Steady(), clock_.System(), limits_);
  const SystemTime online_since = clock_.System();
  EXPECT_EQ(All().presence, Presence::kOnline);
  EXPECT_EQ(All().presence_since, online_since);
  clock_.Advance(milliseconds(100));
  state_.SignOfLife(clock_.Steady(), clock_.System(), limits_);
  EXPECT_EQ(All().presence_since, online_since);
  EXPECT_EQ(All().last_sign_of_life, clock_.System());
  clock_.Advance(limits_.timeout + milliseconds(1));
  EXPECT_EQ(state_.presence(), Presence::kOnline) << "until the sweep looks";
  EXPECT_EQ(state_.Sweep(clock_.Steady(), clock_.System(), limits_), Presence::kOffline);
  EXPECT_EQ(All().presence_since, clock_.System());
}

// A held-back stream hands over messages that arrived long ago.
TEST_F(RobotStateTest, ASignOfLifeThatWaitedIsJudgedAtTheLatestTimeKnown) {
  const SteadyTime arrived = clock_.Steady();
  const SystemTime arrived_system = clock_.System();
  clock_.Advance(limits_.timeout);
  state_.SetReading(RobotState::Reading::kHeldBack, clock_.Steady());
  EXPECT_EQ(state_.Sweep(clock_.Steady(), clock_.System(), limits_), Presence::kUnknown);
  state_.SignOfLife(arrived, arrived_system, limits_);
  EXPECT_EQ(state_.presence(), Presence::kOnline) << "it is within the limit still";
  EXPECT_EQ(All().presence_since, clock_.System()) << "a history never goes back";
  clock_.Advance(milliseconds(1));
  EXPECT_EQ(state_.Sweep(clock_.Steady(), clock_.System(), limits_), Presence::kUnknown);
  state_.SignOfLife(arrived, arrived_system, limits_);
  EXPECT_EQ(state_.presence(), Presence::kUnknown) << "it says nothing of the present any more";
}

TEST_F(RobotStateTest, AnEarlierSignOfLifeTakesNoLaterOnesPlace) {
  const SteadyTime earlier = clock_.Steady();
  const SystemTime earlier_system = clock_.System();
  clock_.Advance(limits_.timeout);
  state_.SignOfLife(clock_.Steady(), clock_.System(), limits_);
  state_.SignOfLife(earlier, earlier_system, limits_);
  EXPECT_EQ(All().last_sign_of_life, clock_.System());
  clock_.Advance(milliseconds(1));
  EXPECT_EQ(state_.Sweep(clock_.Steady(), clock_.System(), limits_), Presence::kOnline);
}

TEST_F(RobotStateTest, HoldingBackCountsToItsEnd) {
  state_.SignOfLife(clock_.Steady(), clock_.System(), limits_);
  state_.SetReading(RobotState::Reading::kHeldBack, clock_.Steady());
  EXPECT_TRUE(state_.held_back());
  clock_.Advance(std::chrono::minutes(5));
  EXPECT_EQ(state_.Sweep(clock_.Steady(), clock_.System(), limits_), Presence::kUnknown);
  state_.SetReading(RobotState::Reading::kFlowing, clock_.Steady());
  EXPECT_FALSE(state_.held_back());
  clock_.Advance(limits_.timeout);
  state_.SetReading(RobotState::Reading::kFlowing, clock_.Steady());
  EXPECT_EQ(state_.Sweep(clock_.Steady(), clock_.System(), limits_), Presence::kUnknown);
  clock_.Advance(milliseconds(1));
  EXPECT_EQ(state_.Sweep(clock_.Steady(), clock_.System(), limits_), Presence::kOffline);
}

TEST_F(RobotStateTest, DroppedFieldsCountFromTheStreamsBegin) {
  state_.CountDropped(3);
  state_.CountDropped(1);
  EXPECT_EQ(All().fields_dropped, 4);
  state_.BeginStream();
  EXPECT_EQ(All().fields_dropped, 0);
}

TEST_F(RobotStateTest, TheBacklogIsWhatTheStreamSaidLast) {
  state_.NoteBatch({.backlog_uplinks = 40}, clock_.Steady(), clock_.System());
  const SystemTime said_at = clock_.System();
  clock_.Advance(milliseconds(5));
  // It says nothing, and then nothing that can be.
  state_.NoteBatch({}, clock_.Steady(), clock_.System());
  state_.NoteBatch({.backlog_uplinks = kBacklogUplinksMax + 1}, clock_.Steady(), clock_.System());
  EXPECT_EQ(All().backlog, (Backlog{.uplinks = 40, .said_at = said_at}));
  EXPECT_FALSE(state_.TakeChanges()) << "it is not stored";
  state_.NoteBatch({.backlog_uplinks = 0}, clock_.Steady(), clock_.System());
  EXPECT_EQ(All().backlog, (Backlog{.uplinks = 0, .said_at = clock_.System()}));
  state_.BeginStream();
  EXPECT_FALSE(All().backlog);
}

TEST_F(RobotStateTest, AClockThatStaysAsItIsIsNoChange) {
  NoteSkew(40);
  EXPECT_TRUE(state_.TakeChanges());
  NoteSkew(40);
  NoteSkew(-200);
  EXPECT_FALSE(state_.TakeChanges());
  EXPECT_EQ(All().clock_skew_ms, 40);
}

TEST(RobotStateDeathTest, ADurableKindIsNeverApplied) {
  testing::ManualClock clock;
  RobotState state(clock.Steady(), clock.Steady(), clock.System());
  std::vector<model::Record> records{
      test::RecordOf(model::Message{.unix_time_ms = kNow, .message = "hello"})};
  EXPECT_DEATH(state.Apply(records, {}), "only live kinds");
}

TEST_F(RobotStateTest, TakesOverWhatItWasNotToldItself) {
  Apply({model::UsageTelemetry{.unix_time_ms = kNow, .reboot_count = 2},
         Extras({{.key = "rpm", .value = 2.0, .unix_time_ms = {}}})});
  LiveBefore before;
  PutInto(before.parts, model::UsageTelemetry{.unix_time_ms = kNow - 5, .reboot_count = 1});
  PutInto(before.parts, model::StatusTelemetry{.unix_time_ms = kNow - 5, .status = "before"});
  PutInto(before.parts, Extras({{.key = "rpm", .value = 1.0, .unix_time_ms = {}},
                                {.key = "temp", .value = 1.0, .unix_time_ms = {}}}));
  before.last_sign_of_life = FromUnixMs(kNow - 5);
  before.clock_skew_ms = 9;
  static_cast<void>(state_.TakeChanges());
  state_.Restore(before, 0);
  const StateSnapshot snapshot = All();
  EXPECT_EQ(snapshot.parts.usage->reboot_count, 2U);
  EXPECT_EQ(snapshot.parts.status->status, "before");
  EXPECT_THAT(KeysOf(snapshot.parts.extras.items()), ElementsAre("temp", "rpm"));
  EXPECT_EQ(snapshot.parts.extras.items().back().second.value, model::Value(2.0));
  EXPECT_EQ(snapshot.last_sign_of_life, FromUnixMs(kNow - 5));
  EXPECT_EQ(snapshot.clock_skew_ms, 9);
  EXPECT_EQ(snapshot.presence, Presence::kUnknown);
  EXPECT_TRUE(
      state_.TakeChanges()->changed.test(static_cast<std::size_t>(storage::LivePart::kExtras)))
      << "the store has neither side whole";
}

TEST_F(RobotStateTest, WhatWasHeardIsNotMadeOlder) {
  state_.SignOfLife(clock_.Steady(), clock_.System(), limits_);
  NoteSkew(1);
  LiveBefore before;
  before.last_sign_of_life = clock_.System() - std::chrono::hours(1);
  before.clock_skew_ms = 9;
  state_.Restore(before, 0);
  EXPECT_EQ(All().last_sign_of_life, clock_.System());
  EXPECT_EQ(All().clock_skew_ms, 1);
  EXPECT_EQ(All().presence, Presence::kOnline);
}

TEST_F(RobotStateTest, ASignOfLifeOfEarlierDaysMakesNobodyOnline) {
  LiveBefore before;
  before.last_sign_of_life = clock_.System();
  state_.Restore(before, 0);
  EXPECT_EQ(state_.Sweep(clock_.Steady(), clock_.System(), limits_), Presence::kUnknown);
  clock_.Advance(limits_.startup_grace + milliseconds(1));
  EXPECT_EQ(state_.Sweep(clock_.Steady(), clock_.System(), limits_), Presence::kOffline);
  EXPECT_FALSE(state_.TakeChanges()) << "what is restored is in the store";
}

TEST_F(RobotStateTest, WhatAnotherHoldsIsShownAsThatOneWroteIt) {
  const storage::StoredPresence stored{Presence::kOnline, FromUnixMs(kNow - 9)};
  state_.FollowHolder({.held_by = "b:1", .written_at = FromUnixMs(kNow)}, stored);
  clock_.Advance(std::chrono::hours(1));
  EXPECT_EQ(state_.Sweep(clock_.Steady(), clock_.System(), limits_), std::nullopt) << "not ours";
  const StateSnapshot shown = All();
  EXPECT_EQ(shown.presence, Presence::kOnline);
  EXPECT_EQ(shown.presence_since, stored.since);
  ASSERT_TRUE(shown.foreign.has_value());
  EXPECT_EQ(shown.foreign->held_by, "b:1");
  EXPECT_EQ(shown.foreign->written_at, FromUnixMs(kNow));
  EXPECT_FALSE(state_.TakeChanges());
}

TEST_F(RobotStateTest, WhoLosesARobotForgetsIt) {
  state_.BeginHold({.since = 3}, clock_.Steady(), clock_.System());
  Apply({model::UsageTelemetry{.unix_time_ms = kNow, .reboot_count = 2}});
  state_.SignOfLife(clock_.Steady(), clock_.System(), limits_);
  state_.NoteBatch({.sent_unix_ms = 1, .backlog_uplinks = 5}, clock_.Steady(), clock_.System());
  state_.Lose();
  Apply({model::UsageTelemetry{.unix_time_ms = kNow, .reboot_count = 3}});
  state_.SignOfLife(clock_.Steady(), clock_.System(), limits_);
  state_.NoteBatch({.sent_unix_ms = 1, .backlog_uplinks = 6}, clock_.Steady(), clock_.System());
  const StateSnapshot shown = All();
  EXPECT_FALSE(shown.parts.usage) << "nor is it told anything any more";
  EXPECT_FALSE(shown.last_sign_of_life);
  EXPECT_FALSE(shown.clock_skew_ms);
  EXPECT_FALSE(shown.backlog);
  EXPECT_EQ(shown.presence, Presence::kOnline) << "until the holder is known";
  EXPECT_EQ(state_.held_since(), 0U);
  EXPECT_FALSE(state_.TakeChanges());
  clock_.Advance(std::chrono::hours(1));
  EXPECT_EQ(state_.Sweep(clock_.Steady(), clock_.System(), limits_), std::nullopt);
}

TEST_F(RobotStateTest, NothingIsCheckpointedBeforeItIsRestored) {
  state_.BeginHold({.since = 3, .was_known = true}, clock_.Steady(), clock_.System());
  EXPECT_TRUE(state_.needs_restore());
  Apply({model::UsageTelemetry{.unix_time_ms = kNow, .reboot_count = 2}});
  EXPECT_FALSE(state_.TakeChanges());
  LiveBefore before;
  PutInto(before.parts, model::StatusTelemetry{.unix_time_ms = kNow - 5, .status = "before"});
  state_.Restore(before, 2);
  EXPECT_FALSE(All().parts.status) << "of an older hold";
  state_.SetRestored(2);
  EXPECT_TRUE(state_.needs_restore());
  state_.Restore(before, 3);
  state_.SetRestored(3);
  EXPECT_EQ(All().parts.status->status, "before");
  EXPECT_EQ(All().parts.usage->reboot_count, 2U);
  EXPECT_TRUE(state_.TakeChanges());
}

TEST_F(RobotStateTest, ARobotThatIsNewToTheStoreHasNothingToRestore) {
  state_.BeginHold({.since = 1, .was_known = false}, clock_.Steady(), clock_.System());
  EXPECT_FALSE(state_.needs_restore());
}

TEST_F(RobotStateTest, AStreamMakesItOursToJudge) {
  state_.FollowHolder({}, {Presence::kOnline, FromUnixMs(kNow - 9)});
  state_.Claim(clock_.Steady());
  EXPECT_FALSE(All().foreign.has_value());
  EXPECT_EQ(All().presence_since, FromUnixMs(kNow - 9)) << "a stream changes nothing";
  EXPECT_EQ(state_.Sweep(clock_.Steady(), clock_.System(), limits_), Presence::kOnline);
  const storage::StoredPresence stored{Presence::kOnline, FromUnixMs(kNow - 9)};
  state_.BeginHold({.since = 3, .presence = stored}, clock_.Steady(), clock_.System());
  state_.FollowHolder({}, {Presence::kOffline, FromUnixMs(kNow)});
  EXPECT_EQ(All().presence, Presence::kOnline) << "the holder of a robot follows no other";
}

TEST_F(RobotStateTest, WhatAStreamToldBeforeTheStoreKnewOfItIsNotNewerThanAnotherVisit) {
  state_.Claim(clock_.Steady());
  Apply({Extras({{.key = "old", .value = std::string("1")}})});
  state_.EndClaim();
  EXPECT_EQ(KeysOf(All().parts.extras.items()).size(), 1U) << "shown until a newer one is known";
  state_.Claim(clock_.Steady());
  EXPECT_TRUE(All().parts.extras.items().empty()) << "it may have been elsewhere since";
  Apply({Extras({{.key = "new", .value = std::string("2")}})});
  state_.BeginHold({.since = 9, .was_known = true}, clock_.Steady(), clock_.System());
  EXPECT_THAT(KeysOf(All().parts.extras.items()), ElementsAre("new"));
  state_.EndClaim();
  state_.Claim(clock_.Steady());
  EXPECT_THAT(KeysOf(All().parts.extras.items()), ElementsAre("new")) << "it is ours";
}

TEST_F(RobotStateTest, WhoFollowsAHolderForgetsWhatAStreamTold) {
  state_.Claim(clock_.Steady());
  Apply({Extras({{.key = "old", .value = std::string("1")}})});
  state_.EndClaim();
  state_.FollowHolder({.held_by = "b:2"}, {Presence::kOnline, FromUnixMs(kNow)});
  EXPECT_TRUE(All().parts.extras.items().empty());
}

TEST_F(RobotStateTest, WhoGetsARobotBackOfWhichTheStoreHasNoPresenceJudgesIt) {
  state_.SignOfLife(clock_.Steady(), clock_.System(), limits_);
  state_.Lose();
  clock_.Advance(limits_.timeout + milliseconds(1));
  state_.BeginHold({.since = 3}, clock_.Steady(), clock_.System());
  EXPECT_EQ(All().presence, Presence::kUnknown) << "until it is heard";
  clock_.Advance(limits_.startup_grace + milliseconds(1));
  EXPECT_EQ(state_.Sweep(clock_.Steady(), clock_.System(), limits_), Presence::kOffline);
  state_.SignOfLife(clock_.Steady(), clock_.System(), limits_);
  EXPECT_EQ(All().presence, Presence::kOnline);
}

TEST_F(RobotStateTest, WhatIsReadForALostHoldIsNotTaken) {
  state_.BeginHold({.since = 3, .was_known = true}, clock_.Steady(), clock_.System());
  state_.Lose();
  LiveBefore before;
  PutInto(before.parts, model::StatusTelemetry{.unix_time_ms = kNow, .status = "old"});
  Reported reported;
  reported.booted_at = FromUnixMs(5);
  for (const storage::Epoch read_under : {storage::Epoch{0}, storage::Epoch{3}}) {
    state_.Restore(before, read_under);
    state_.Restore(reported, read_under);
  }
  EXPECT_FALSE(All().parts.status);
  state_.LookAt([](const StateView& view) { EXPECT_FALSE(view.reported.booted_at); });
}

TEST_F(RobotStateTest, NobodyElseIsFollowedWhileAStreamIsHere) {
  state_.Claim(clock_.Steady());
  state_.FollowHolder({.held_by = "b:1"}, {Presence::kOffline, FromUnixMs(kNow)});
  EXPECT_FALSE(All().foreign.has_value()) << "the store is about to learn of the stream";
  state_.EndClaim();
  state_.FollowHolder({.held_by = "b:1"}, {Presence::kOffline, FromUnixMs(kNow)});
  EXPECT_EQ(All().foreign->held_by, "b:1");
}

TEST_F(RobotStateTest, RunsThatEndedBeforeTheStoreWasReadStayEnded) {
  const auto report = [this](const std::string& run, model::MissionStatus status) {
    model::MissionRunStatus body;
    body.run_id = run;
    body.status = status;
    state_.KeepReport(body, SystemTime());
  };
  report("ended", model::MissionStatus::kComplete);
  report("again", model::MissionStatus::kError);
  report("again", model::MissionStatus::kRunning);
  Reported before;
  for (const char* run : {"older", "ended", "again"}) before.open_runs.Put(RunKey("", run), 1.0);
  before.booted_at = FromUnixMs(5);
  state_.Restore(std::move(before), 0);
  std::vector<std::string> open;
  state_.LookAt([&](const StateView& view) {
    for (const auto& [key, progress] : view.reported.open_runs.items()) open.push_back(key);
    EXPECT_EQ(view.reported.booted_at, FromUnixMs(5));
  });
  EXPECT_EQ(open, (std::vector<std::string>{"/older", "/again"}));
}

}  // namespace
}  // namespace uplink::robot
