// How much memory the live state of one robot takes, and that it is counted.
#include <cstddef>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/robot/robot_state.h"
#include "tests/support/manual_clock.h"
#include "tests/support/records.h"

namespace uplink::robot {
namespace {

using storage::LivePart;

constexpr std::int64_t kNow = 1'763'683'200'000;
/// The longest text of a reading, all of it control characters: U+FFFD has three bytes.
constexpr std::size_t kLongText = 4'094;

class LiveMemoryTest : public ::testing::Test {
 protected:
  LiveMemoryTest() { state_->CountIn(total_); }

  void Apply(const model::Body& body) {
    std::vector<model::Record> records;
    records.push_back(test::RecordOf(body));
    state_->Apply(records, {});
  }
  void Read(const std::string& key, model::Value value) {
    model::TelemetryExtras extras{.unix_time_ms = kNow};
    extras.kv.push_back({.key = key, .value = std::move(value), .unix_time_ms = {}});
    Apply(extras);
  }
  [[nodiscard]] StateSnapshot All() const { return state_->Snapshot(RobotState::Parts::kAll); }
  [[nodiscard]] std::size_t BytesOf(LivePart part) const {
    return state_->live_part_bytes()[static_cast<std::size_t>(part)];
  }

  testing::ManualClock clock_;
  std::shared_ptr<LiveTotal> total_ = std::make_shared<LiveTotal>();
  std::unique_ptr<RobotState> state_ =
      std::make_unique<RobotState>(clock_.Steady(), clock_.Steady(), clock_.System());
};

std::size_t TextBytesOf(const LiveParts& parts) {
  std::size_t bytes = 0;
  for (const auto& [key, extra] : parts.extras.items()) {
    bytes += key.size();
    if (const auto* text = std::get_if<std::string>(&extra.value)) bytes += text->size();
  }
  return bytes;
}

std::string KeyOf(std::size_t number, std::size_t bytes) {
  std::string key = std::to_string(number);
  return key + std::string(bytes - key.size(), 'k');
}

TEST_F(LiveMemoryTest, APartOfKeysWithLongTextsIsBoundedAfterReplacement) {
  constexpr std::size_t kKeys = 1'024;
  for (std::size_t i = 0; i < kKeys; ++i) Read(KeyOf(i, 8), std::string(kLongText, '\x01'));
  const StateSnapshot state = All();
  EXPECT_LE(TextBytesOf(state.parts), kLivePartBytesMax);
  EXPECT_GT(TextBytesOf(state.parts), kLivePartBytesMax / 2);
  EXPECT_LE(total_->bytes(), kLivePartBytesMax + state.parts.extras.items().size() * kPlaceBytes);
  EXPECT_EQ(state.parts.extras.items().back().first, KeyOf(kKeys - 1, 8)) << "the latest stays";
  EXPECT_EQ(state.keys_evicted, kKeys - state.parts.extras.items().size());
}

TEST_F(LiveMemoryTest, AsManyNumbersUnderLongKeysAsThereMayBeHaveRoom) {
  constexpr std::size_t kKeys = 1'024;
  for (std::size_t i = 0; i < kKeys; ++i) Read(KeyOf(i, 128), 1.0);
  EXPECT_EQ(All().parts.extras.items().size(), kKeys);
  EXPECT_EQ(All().keys_evicted, 0U);
  Read(KeyOf(kKeys, 128), 1.0);
  EXPECT_EQ(All().parts.extras.items().size(), kKeys);
  EXPECT_EQ(All().keys_evicted, 1U);
}

TEST_F(LiveMemoryTest, AsManyDirectivesWithLongIdsAsThereMayBeHaveRoom) {
  constexpr std::size_t kKeys = 1'024;
  for (std::size_t i = 0; i < kKeys; ++i) {
    Apply(model::SpatialDirectiveStatus{.directive_id = KeyOf(i, 128)});
  }
  EXPECT_EQ(All().parts.directives.items().size(), kKeys);
  EXPECT_EQ(All().keys_evicted, 0U);
}

TEST_F(LiveMemoryTest, TheCountIsThatOfWhatIsHeldWhateverComes) {
  // Long and short texts under few keys: a short one may lie in the memory of a long one.
  const std::size_t sizes[] = {1, 4'000, 3, 900, 20, 2'000};
  for (std::size_t i = 0; i < 3'000; ++i) {
    Read(KeyOf(i * 7 % 600, 24), std::string(sizes[i % std::size(sizes)], 'v'));
    if (i % 100 != 0) continue;
    std::size_t held = 0;
    state_->LookAt([&held](const StateView& view) {
      for (const auto& [key, extra] : view.parts.extras.items()) {
        held += BytesOfItem(key, extra).held;
      }
    });
    ASSERT_EQ(total_->bytes(), held) << i;
  }
  EXPECT_GT(All().keys_evicted, 0U);
}

TEST_F(LiveMemoryTest, EachPartCounts) {
  Apply(model::MotionTelemetry{.unix_time_ms = kNow});
  EXPECT_EQ(total_->bytes(), 0U) << "it lies within the robot";
  Apply(model::StatusTelemetry{.unix_time_ms = kNow, .status = std::string(500, 's')});
  EXPECT_GE(BytesOf(LivePart::kStatus), 500U);
  Apply(model::SystemHealth{.unix_time_ms = kNow, .device_id = "main"});
  EXPECT_GT(BytesOf(LivePart::kHealth), 0U);
  model::RcanState rcan;
  rcan.joints.resize(20);
  state_->Apply(std::move(rcan), SteadyTime());
  EXPECT_GE(BytesOf(LivePart::kRcan), 20 * sizeof(model::RcanJoint));
  EXPECT_EQ(total_->bytes(), state_->live_bytes());
  EXPECT_EQ(total_->bytes(),
            BytesOf(LivePart::kStatus) + BytesOf(LivePart::kHealth) + BytesOf(LivePart::kRcan));
}

TEST_F(LiveMemoryTest, APartThatIsDroppedIsFreeAndGoesFromTheStoreToo) {
  Read("a", std::string(2'000, 'x'));
  Apply(model::StatusTelemetry{.unix_time_ms = kNow, .status = std::string(500, 's')});
  (void)state_->TakeChanges();
  const std::size_t held = BytesOf(LivePart::kExtras);
  const std::size_t before = total_->bytes();
  EXPECT_EQ(state_->DropLivePart(LivePart::kExtras), held);
  EXPECT_EQ(total_->bytes(), before - held);
  EXPECT_TRUE(All().parts.extras.items().empty());
  EXPECT_TRUE(All().parts.status.has_value());
  const std::optional<LiveChanges> changes = state_->TakeChanges();
  ASSERT_TRUE(changes.has_value());
  EXPECT_TRUE(changes->changed.test(static_cast<std::size_t>(LivePart::kExtras)));
  Read("a", std::string(2'000, 'x'));
  EXPECT_EQ(total_->bytes(), before) << "what comes next is held again";
}

TEST_F(LiveMemoryTest, ARobotThatIsLostOrGoneCountsNoMore) {
  Read("a", std::string(2'000, 'x'));
  EXPECT_GT(total_->bytes(), 2'000U);
  state_->Lose();
  EXPECT_EQ(total_->bytes(), 0U);
  state_->Claim(clock_.Steady());
  Read("a", std::string(2'000, 'x'));
  EXPECT_GT(total_->bytes(), 2'000U);
  state_.reset();
  EXPECT_EQ(total_->bytes(), 0U);
}

TEST_F(LiveMemoryTest, WhatIsRestoredCounts) {
  LiveBefore before;
  PutInto(before.parts,
          model::TelemetryExtras{
              .unix_time_ms = kNow,
              .kv = {{.key = "a", .value = std::string(2'000, 'x'), .unix_time_ms = {}}}});
  state_->Restore(std::move(before), state_->held_since());
  EXPECT_GT(total_->bytes(), 2'000U);
  EXPECT_EQ(total_->bytes(), state_->live_bytes());
}

TEST_F(LiveMemoryTest, APartThatWasDroppedBeforeItsRestoreComesBackNoOlder) {
  state_->BeginHold({.since = 3, .was_known = true}, clock_.Steady(), clock_.System());
  Read("new", 1.0);
  Apply(model::StatusTelemetry{.unix_time_ms = kNow, .status = "new"});
  state_->DropLivePart(LivePart::kExtras);
  state_->DropLivePart(LivePart::kStatus);
  Read("newest", 1.0);
  LiveBefore before;
  PutInto(before.parts, model::StatusTelemetry{.unix_time_ms = kNow - 9, .status = "old"});
  PutInto(before.parts, model::UsageTelemetry{.unix_time_ms = kNow - 9});
  PutInto(before.parts,
          model::TelemetryExtras{.unix_time_ms = kNow - 9,
                                 .kv = {{.key = "old", .value = 1.0, .unix_time_ms = {}}}});
  state_->Restore(std::move(before), 3);
  state_->SetRestored(3);
  EXPECT_FALSE(All().parts.status.has_value());
  EXPECT_EQ(All().parts.extras.Find("old"), nullptr);
  EXPECT_NE(All().parts.extras.Find("newest"), nullptr) << "what came after it stays";
  EXPECT_TRUE(All().parts.usage.has_value()) << "nothing of it was dropped";
  EXPECT_EQ(total_->bytes(), state_->live_bytes());
  const std::optional<LiveChanges> changes = state_->TakeChanges();
  ASSERT_TRUE(changes.has_value());
  EXPECT_TRUE(changes->changed.test(static_cast<std::size_t>(LivePart::kStatus)))
      << "the store forgets it";
  EXPECT_TRUE(changes->changed.test(static_cast<std::size_t>(LivePart::kExtras)));
}

TEST_F(LiveMemoryTest, APartThatWasDroppedIsRestoredOnceTheRobotWasElsewhere) {
  Apply(model::StatusTelemetry{.unix_time_ms = kNow, .status = "here"});
  state_->DropLivePart(LivePart::kStatus);
  state_->Lose();
  state_->BeginHold({.since = 5, .was_known = true}, clock_.Steady(), clock_.System());
  LiveBefore before;
  PutInto(before.parts, model::StatusTelemetry{.unix_time_ms = kNow + 9, .status = "there"});
  state_->Restore(std::move(before), 5);
  EXPECT_EQ(All().parts.status->status, "there");
}

TEST_F(LiveMemoryTest, OfAPartThatWasDroppedNothingHasArrived) {
  const SteadyTime now = clock_.Steady() + std::chrono::seconds(1);
  std::vector<model::Record> records;
  records.push_back(test::RecordOf(model::StatusTelemetry{.unix_time_ms = kNow}));
  state_->Apply(records, now);
  state_->Apply(model::RcanState(), now);
  const auto arrived = [this] {
    std::pair<SteadyTime, SteadyTime> of;
    state_->LookAt([&of](const StateView& view) { of = {view.status_arrived, view.rcan_arrived}; });
    return of;
  };
  state_->DropLivePart(LivePart::kUsage);
  EXPECT_EQ(arrived(), std::pair(now, now));
  state_->DropLivePart(LivePart::kStatus);
  EXPECT_EQ(arrived(), std::pair(SteadyTime(), now));
  state_->DropLivePart(LivePart::kRcan);
  EXPECT_EQ(arrived(), std::pair(SteadyTime(), SteadyTime()));
}

TEST_F(LiveMemoryTest, PastTheTriggerWhoAppliesCallsWhoIsTold) {
  int calls = 0;
  total_->OnOver([&calls] { ++calls; });
  total_->SetTrigger(4'000);
  Read("a", std::string(2'000, 'x'));
  EXPECT_EQ(calls, 0);
  Read("b", std::string(2'000, 'x'));
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace uplink::robot
