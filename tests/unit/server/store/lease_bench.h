#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "server/journal/turns.h"
#include "server/store/lease_rounds.h"
#include "tests/support/fake_leases.h"
#include "tests/support/fake_store.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::store {

inline constexpr storage::ProcessId kSelf{1};
inline constexpr storage::ProcessId kOther{2};
inline constexpr storage::ProcessId kThird{3};

/// This process and another one on one database; the other is played by the test.
class LeaseRoundsTest : public ::testing::Test {
 protected:
  LeaseRoundsTest() {
    fleet_.OnPresence(
        [this](const storage::RobotRef& robot, const storage::StoredPresence& now, auto why) {
          journals_.NotePresence(robot, now.presence, now.since, why, now.parked_until);
        });
    auto leases = std::make_unique<testing::FakeLeases>(database_, kSelf);
    leases_ = leases.get();
    rounds_ = std::make_unique<LeaseRounds>(
        std::move(leases),
        LeaseRounds::Context{
            .fleet = fleet_,
            .journals = journals_,
            .clock = clock_,
            .logger = logger_,
            .probe = probe_,
            .process = kSelf,
            .is_gone = [](std::string_view) { return false; },
            .is_forgotten = [this](SystemTime heard_at) { return heard_at < heard_since_; },
            .on_shut_out = [this] { ++shut_outs_; }});
    rounds_->SetPort(7443);
  }

  void OpenAtOther(model::Presence presence = model::Presence::kOnline) {
    const storage::OpenRequest request{.robot = robot_, .at = clock_.System()};
    const auto opened = other_.OpenStreams({&request, 1});
    ASSERT_TRUE(opened.ok());
    storage::Batch batch;
    batch.presence_session = model::SessionId({8});
    batch.presence = {{robot_, presence, FromUnixMs(7), ++number_, opened->front().held_since}};
    ASSERT_TRUE(other_.Commit(batch).ok());
  }
  /// A third process adopted it, since the other one fell silent, and stopped after that.
  void AdoptAtThird() {
    const storage::AdoptRequest request{
        .robot = robot_, .holder = kOther, .end = storage::HolderEnd::kSilent};
    const auto adopted = third_.Adopt({&request, 1});
    ASSERT_TRUE(adopted.ok() && adopted->front().held_since);
    database_.Renew(kThird, {.name = "c:3", .life = "there"});
    rounds_->Round();
    database_.Release(kThird);
  }
  void RenewOther() { database_.Renew(kOther, {.name = "b:2", .life = "there"}); }
  void Pass(milliseconds time) {
    for (milliseconds passed{0}; passed < time; passed += kLookEvery) {
      clock_.Advance(kLookEvery);
      rounds_->Round();
      while (journal_.turns().Advance() == journal::Step::kWorked) {
      }
      fleet_.Sweep(std::chrono::hours(1));
    }
  }
  robot::StateSnapshot Shown() {
    return fleet_.Find(robot_->ruri)->state.Snapshot(robot::RobotState::Parts::kNone);
  }
  std::vector<model::Presence> History() {
    std::vector<model::Presence> history;
    const auto changes = ours_.PresenceChanges({});
    for (const auto& row : changes->rows) history.push_back(row.presence);
    return history;
  }

  testing::ManualClock clock_;
  testing::FakeDatabase database_;
  testing::FakeStore ours_{database_, kSelf};
  testing::FakeStore other_{database_, kOther};
  testing::FakeStore third_{database_, kThird};
  const storage::RobotRef robot_ =
      std::make_shared<const model::RobotId>(model::RobotId{"rcan://r", "f"});
  /// Who was heard last before is forgotten.
  SystemTime heard_since_;
  int shut_outs_ = 0;
  model::Seq number_ = 0;
  metrics::Ledger ledger_;
  journal::JournalProbe journal_probe_;
  fleet::Fleet fleet_{clock_, 5, {}};
  journal::Journal journal_{ours_, {}, clock_, ledger_, journal_probe_, kSelf};
  journal::Shards journals_{{&journal_}};
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  LeaseProbe probe_;
  testing::FakeLeases* leases_ = nullptr;
  std::unique_ptr<LeaseRounds> rounds_;
};

}  // namespace uplink::store
