#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "tests/contract/store_contract.h"

/// What operators decide, and what is kept of what they did.
namespace uplink::testing {
namespace {

using storage::AccessVersion;
using storage::AuditProof;
using storage::AuditQuery;
using storage::AuditRow;
using storage::Revocation;
using storage::RevokedBy;
using storage::RobotSetting;
using storage::SettingChange;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::Not;
using ::testing::Pair;
using ::testing::SizeIs;

constexpr std::int64_t kDayMs = 86'400'000;
const std::string kRuri = "rcan://robots/a";

class AccessContract : public StoreContract {
 protected:
  AccessContract() { Fresh(); }

  storage::AccessStore& Access() { return store_->access(); }

  static AuditRow Did(std::string action, std::int64_t after_ms = 0, std::string fleet = "f1") {
    return {.at = Time(after_ms),
            .proof = AuditProof::kToken,
            .who = "t-1",
            .from = "192.0.2.1",
            .action = std::move(action),
            .target = kRuri,
            .fleet = std::move(fleet),
            .outcome = "ok",
            .detail = "why"};
  }
  static Revocation Of(std::string value, bool revoked = true,
                       RevokedBy by = RevokedBy::kCertificate) {
    Revocation revocation;
    revocation.by = by;
    revocation.value = std::move(value);
    revocation.revoked = revoked;
    revocation.reason = revoked ? "stolen" : "";
    return revocation;
  }
  template <typename T>
  static T ValueOf(absl::StatusOr<T> value) {
    EXPECT_TRUE(value.ok()) << value.status();
    return value.ok() ? *std::move(value) : T();
  }
  bool Revoke(const Revocation& revocation, std::int64_t after_ms = 0) {
    return ValueOf(Access().Revoke(revocation, Did("certificate_revoke", after_ms)));
  }
  RobotSetting Change(const SettingChange& change, std::int64_t after_ms = 0) {
    return ValueOf(Access().Change(change, Did("robot_change", after_ms))).setting;
  }
  RobotSetting Block(std::string why, bool blocked = true) {
    SettingChange change;
    change.ruri = kRuri;
    change.blocked = blocked;
    change.blocked_why = std::move(why);
    return Change(change);
  }
  AccessVersion Version() { return ValueOf(Access().Version()); }
  std::vector<std::string> RevokedAfter(AccessVersion after = 0) {
    std::vector<std::string> values;
    for (const Revocation& one : ValueOf(Access().RevocationsAfter(after))) {
      values.push_back((one.revoked ? "" : "not ") + one.value);
    }
    return values;
  }
  std::vector<RobotSetting> SettingsAfter(AccessVersion after = 0) {
    return ValueOf(Access().SettingsAfter(after));
  }
  std::vector<AuditRow> Audit(const AuditQuery& query = {}) {
    return RowsOf(store_->reader().Audit(query));
  }
  std::vector<std::string> Actions(const AuditQuery& query = {}) {
    std::vector<std::string> actions;
    for (const AuditRow& row : Audit(query)) actions.push_back(row.action);
    return actions;
  }
};

TEST_P(AccessContract, BeginsWithNothing) {
  EXPECT_EQ(Version(), 0U);
  EXPECT_THAT(RevokedAfter(), IsEmpty());
  EXPECT_THAT(SettingsAfter(), IsEmpty());
  EXPECT_THAT(Audit(), IsEmpty());
}

TEST_P(AccessContract, ARevocationIsAllThatWasGiven) {
  EXPECT_TRUE(Revoke(Of("0A CN=robots", true, RevokedBy::kIssuerSerial), 5));
  const auto all = ValueOf(Access().RevocationsAfter(0));
  ASSERT_THAT(all, SizeIs(1));
  Revocation expected = Of("0A CN=robots", true, RevokedBy::kIssuerSerial);
  expected.at = Time(5);
  expected.who = "t-1";
  expected.version = Version();
  EXPECT_EQ(all[0], expected);
  EXPECT_THAT(Audit(), ElementsAre(Did("certificate_revoke", 5)));
}

TEST_P(AccessContract, EachChangeHasAHigherVersionAndIsFoundByIt) {
  EXPECT_TRUE(Revoke(Of("a")));
  const AccessVersion first = Version();
  EXPECT_GT(first, 0U);
  EXPECT_TRUE(Revoke(Of("b")));
  Block("lost");
  const AccessVersion third = Version();
  EXPECT_THAT(RevokedAfter(), ElementsAre("a", "b"));
  EXPECT_THAT(RevokedAfter(first), ElementsAre("b"));
  EXPECT_THAT(RevokedAfter(third), IsEmpty());
  EXPECT_THAT(SettingsAfter(first), SizeIs(1));
  EXPECT_EQ(SettingsAfter()[0].version, third);
  EXPECT_THAT(SettingsAfter(third), IsEmpty());
  store_->Reopen();
  EXPECT_EQ(Version(), third);
}

TEST_P(AccessContract, WhatIsTakenBackIsToldAsWell) {
  EXPECT_FALSE(Revoke(Of("a", false))) << "it was never revoked";
  EXPECT_EQ(Version(), 0U);
  EXPECT_TRUE(Revoke(Of("a")));
  EXPECT_FALSE(Revoke(Of("a"))) << "it is already";
  EXPECT_TRUE(Revoke(Of("a", true, RevokedBy::kKey))) << "a key of the same digits";
  const AccessVersion before = Version();
  EXPECT_TRUE(Revoke(Of("a", false)));
  EXPECT_THAT(RevokedAfter(before), ElementsAre("not a"));
  EXPECT_TRUE(Revoke(Of("a")));
  EXPECT_THAT(RevokedAfter(), ElementsAre("a", "a"));
  EXPECT_THAT(Audit(), SizeIs(4)) << "what changed nothing leaves none";
}

TEST_P(AccessContract, NoServersClockTakesAwayWhatWasTakenBack) {
  Revoke(Of("a"));
  Revoke(Of("a", false));
  Change({.ruri = kRuri, .disconnect = true});
  SettingChange other{.ruri = "rcan://robots/b"};
  other.registered = false;
  for (const std::int64_t after_ms : {40 * kDayMs, -40 * kDayMs}) {
    Revoke(Of("b" + std::to_string(after_ms)), after_ms);
    other.registered = !*other.registered;
    Change(other, after_ms);
  }
  EXPECT_THAT(RevokedAfter(), Contains("not a"));
  EXPECT_THAT(SettingsAfter(), Contains(Field(&RobotSetting::ruri, kRuri)));
}

TEST_P(AccessContract, TheNewestThatWereTakenBackStay) {
  Revoke(Of("stays"));
  SettingChange blocked{.ruri = "rcan://robots/stays"};
  blocked.blocked = true;
  Change(blocked);
  const auto value = [](std::size_t number) { return "r" + std::to_string(number); };
  for (std::size_t i = 0; i <= storage::kTakenBackKept; ++i) {
    Revoke(Of(value(i)));
    Revoke(Of(value(i), false));
    Change({.ruri = "rcan://robots/" + value(i), .disconnect = true});
  }
  EXPECT_THAT(RevokedAfter(), SizeIs(storage::kTakenBackKept + 2)) << "a change drops, then sets";
  Revoke(Of("new"));
  Change(SettingChange{.ruri = kRuri, .registered = true});
  const std::vector<std::string> values = RevokedAfter();
  EXPECT_THAT(values, SizeIs(storage::kTakenBackKept + 2));
  EXPECT_THAT(values, Not(Contains("not " + value(0))));
  EXPECT_THAT(values, IsSupersetOf({std::string("stays"), "not " + value(1), std::string("new")}));
  const std::vector<RobotSetting> settings = SettingsAfter();
  ASSERT_THAT(settings, SizeIs(storage::kTakenBackKept + 2));
  EXPECT_EQ(settings[0].ruri, blocked.ruri);
  EXPECT_EQ(settings[1].ruri, "rcan://robots/" + value(1));
  EXPECT_EQ(settings.back().ruri, kRuri);
}

TEST_P(AccessContract, ASettingIsAllThatWasSet) {
  SettingChange change;
  change.ruri = kRuri;
  change.blocked = true;
  change.blocked_why = "lost";
  change.registered = true;
  change.labels = {{"hall", "3"}, {"owner", "ä\"\\"}};
  change.note = "line 1\nline 2";
  change.disconnect = true;
  const RobotSetting after = Change(change, 7);
  RobotSetting expected;
  expected.ruri = kRuri;
  expected.blocked = true;
  expected.blocked_why = "lost";
  expected.blocked_by = "t-1";
  expected.blocked_at = Time(7);
  expected.registered = true;
  expected.labels = change.labels;
  expected.note = "line 1\nline 2";
  expected.disconnect_at = Time(7);
  expected.version = Version();
  EXPECT_EQ(after, expected);
  EXPECT_THAT(SettingsAfter(), ElementsAre(expected));
}

TEST_P(AccessContract, AChangeLeavesWhatItDoesNotName) {
  SettingChange change;
  change.ruri = kRuri;
  change.labels = {{"a", "1"}, {"b", "2"}};
  Change(change);
  Block("lost");
  change.labels = {{"a", ""}, {"c", "3"}};
  const RobotSetting after = Change(change);
  EXPECT_TRUE(after.blocked);
  EXPECT_EQ(after.blocked_why, "lost");
  EXPECT_THAT(after.labels, ElementsAre(Pair("b", "2"), Pair("c", "3")));
  const RobotSetting unblocked = Block("", false);
  EXPECT_FALSE(unblocked.blocked);
  EXPECT_EQ(unblocked.blocked_by, "");
  EXPECT_EQ(unblocked.blocked_at, std::nullopt);
  EXPECT_THAT(unblocked.labels, SizeIs(2));
  const AccessVersion before = Version();
  EXPECT_EQ(Block("", false), unblocked);
  EXPECT_EQ(Version(), before) << "it changed nothing";
  EXPECT_THAT(Audit(), SizeIs(4));
  change.labels = {{"c", "3"}, {"never", ""}};
  const auto same = ValueOf(Access().Change(change, Did("robot_change")));
  EXPECT_FALSE(same.changed);
  EXPECT_EQ(same.setting, unblocked);
  EXPECT_THAT(Audit(), SizeIs(4));
  change.labels = {{"c", "4"}};
  EXPECT_TRUE(ValueOf(Access().Change(change, Did("robot_change"))).changed);
}

TEST_P(AccessContract, ASecondBlockKeepsTheFirst) {
  const RobotSetting first = Block("stolen");
  SettingChange change{.ruri = kRuri};
  change.blocked = true;
  AuditRow later = Did("robot_block", 60'000);
  later.who = "t-2";
  const auto again = ValueOf(Access().Change(change, later));
  EXPECT_FALSE(again.changed);
  EXPECT_EQ(again.setting, first);
  change.blocked_why = "stolen, and seen in the north";
  const auto reworded = ValueOf(Access().Change(change, later));
  EXPECT_TRUE(reworded.changed);
  EXPECT_EQ(reworded.setting.blocked_why, change.blocked_why);
  EXPECT_EQ(reworded.setting.blocked_by, first.blocked_by);
  EXPECT_EQ(reworded.setting.blocked_at, first.blocked_at);
  EXPECT_THAT(SettingsAfter(), ElementsAre(reworded.setting));
  Block("", false);
  const auto anew = ValueOf(Access().Change(change, later));
  EXPECT_EQ(anew.setting.blocked_by, "t-2");
  EXPECT_EQ(anew.setting.blocked_at, later.at);
}

TEST_P(AccessContract, EachDisconnectIsANewOne) {
  SettingChange change;
  change.ruri = kRuri;
  change.disconnect = true;
  const RobotSetting first = Change(change);
  const RobotSetting second = Change(change);
  EXPECT_EQ(first.disconnect_at, Time());
  EXPECT_GT(second.disconnect_at, first.disconnect_at);
  EXPECT_GT(second.version, first.version);
}

TEST_P(AccessContract, WhatNoStoreTakesLeavesNothing) {
  const auto code = [](const auto& result) { return result.status().code(); };
  const AuditRow did = Did("x");
  EXPECT_EQ(code(Access().Revoke(Of(""), did)), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code(Access().Revoke(Of("\xFF"), did)), absl::StatusCode::kInvalidArgument);
  SettingChange change;
  EXPECT_EQ(code(Access().Change(change, did)), absl::StatusCode::kInvalidArgument);
  change.ruri = kRuri;
  change.note = std::string(storage::kNoteBytesMax + 1, 'n');
  EXPECT_EQ(code(Access().Change(change, did)), absl::StatusCode::kInvalidArgument);
  change.note.reset();
  change.labels = {{"", "x"}};
  EXPECT_EQ(code(Access().Change(change, did)), absl::StatusCode::kInvalidArgument);
  change.labels.clear();
  for (std::size_t i = 0; i <= storage::kLabelsMax; ++i) change.labels[std::to_string(i)] = "x";
  EXPECT_EQ(code(Access().Change(change, did)), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(SettingsAfter(), IsEmpty());
  EXPECT_THAT(Audit(), IsEmpty());
  EXPECT_EQ(Version(), 0U);
  EXPECT_TRUE(Revoke(Of("a"))) << "no transaction was left open";
}

TEST_P(AccessContract, AnAcknowledgedFaultSaysWhoSawIt) {
  model::Fault other = Fault("f");
  other.source = "arm";
  Commit({Good(1, Fault("f")), Good(2, other), Good(3, Fault("g"))});
  ASSERT_TRUE(Access().Acknowledge({robot_->ruri, "f", "on it"}, Did("fault_ack", 9)).ok());
  std::size_t seen = 0;
  for (const storage::FaultRow& row : Active()) {
    if (row.fault.fault_id == "g") {
      EXPECT_EQ(row.acknowledged_at, std::nullopt);
      continue;
    }
    ++seen;
    EXPECT_EQ(row.acknowledged_at, Time(9));
    EXPECT_EQ(row.acknowledged_by, "t-1");
    EXPECT_EQ(row.acknowledged_note, "on it");
  }
  EXPECT_EQ(seen, 2U) << "of both sources";
  EXPECT_THAT(Actions(), ElementsAre("fault_ack"));
  EXPECT_EQ(Version(), 0U) << "servers have nothing to follow";
}

TEST_P(AccessContract, ANewRaiseClearsTheAcknowledgement) {
  Commit({Good(1, Fault("f"))});
  ASSERT_TRUE(Access().Acknowledge({robot_->ruri, "f", "on it"}, Did("fault_ack")).ok());
  Commit({Good(2, Fault("f"))});
  ASSERT_THAT(Active(), SizeIs(1));
  EXPECT_EQ(Active()[0].acknowledged_at, std::nullopt);
  EXPECT_EQ(Active()[0].acknowledged_by, "");
  EXPECT_EQ(Active()[0].acknowledged_note, "");
  ASSERT_TRUE(Access().Acknowledge({robot_->ruri, "f", ""}, Did("fault_ack")).ok());
  Commit({Good(3, Cleared("f")), Good(4, Fault("f"))});
  EXPECT_EQ(Active()[0].acknowledged_at, std::nullopt);
}

TEST_P(AccessContract, WhatIsNotActiveIsNotFound) {
  Commit({Good(1, Fault("f")), Good(2, Cleared("f"))});
  for (const std::string& ruri : {robot_->ruri, kRuri + "/none"}) {
    EXPECT_EQ(Access().Acknowledge({ruri, "f", ""}, Did("fault_ack")).code(),
              absl::StatusCode::kNotFound);
  }
  EXPECT_THAT(Audit(), IsEmpty());
  ASSERT_TRUE(Access().Append(Did("later")).ok()) << "no transaction was left open";
}

TEST_P(AccessContract, TheAuditIsReadInPages) {
  for (int i = 0; i < 7; ++i) {
    ASSERT_TRUE(Access().Append(Did("a" + std::to_string(i), i / 3)).ok());
  }
  EXPECT_THAT(Actions(), ElementsAre("a6", "a5", "a4", "a3", "a2", "a1", "a0"));
  for (const auto order : {storage::ListOrder::kNewestFirst, storage::ListOrder::kOldestFirst}) {
    AuditQuery query;
    query.rows.order = order;
    query.rows.page_size = 2;
    std::vector<std::string> walked;
    do {
      const auto page = ValueOf(store_->reader().Audit(query));
      for (const AuditRow& row : page.rows) walked.push_back(row.action);
      query.rows.page_token = page.next_token;
    } while (!query.rows.page_token.empty() && walked.size() < 10);
    query.rows = {};
    query.rows.order = order;
    EXPECT_EQ(walked, Actions(query));
  }
  AuditQuery query;
  query.rows.from = Time(1);
  query.rows.to = Time(1);
  EXPECT_THAT(Actions(query), ElementsAre("a5", "a4", "a3"));
  query.rows.page_token = "x";
  EXPECT_EQ(store_->reader().Audit(query).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST_P(AccessContract, TheAuditIsFoundByWhoWhatOnWhatAndFleet) {
  AuditRow reload = Did("reload", 1, "");
  reload.who = "server";
  reload.proof = AuditProof::kServer;
  reload.target = "";
  AuditRow other = Did("robot_block", 2, "f2");
  other.target = "rcan://robots/b";
  for (const AuditRow& row : {Did("robot_block"), reload, other}) {
    ASSERT_TRUE(Access().Append(row).ok());
  }
  EXPECT_THAT(Audit({.rows = {}, .who = "server"}), ElementsAre(reload));
  EXPECT_THAT(Audit({.rows = {}, .action = "robot_block"}), SizeIs(2));
  EXPECT_THAT(Audit({.rows = {}, .target = other.target}), ElementsAre(other));
  EXPECT_THAT(Audit({.rows = {}, .who = "t-1", .action = "robot_block", .target = kRuri}),
              SizeIs(1));
  AuditQuery of_fleet;
  of_fleet.rows.fleets = {"f1"};
  EXPECT_THAT(Audit(of_fleet), ElementsAre(Did("robot_block")));
  of_fleet.rows.fleets = {"f1", "f2"};
  EXPECT_THAT(Audit(of_fleet), SizeIs(2)) << "what is no fleet's is not shown";
  of_fleet.rows.robots_alone = true;
  EXPECT_THAT(Audit(of_fleet), SizeIs(2));
  of_fleet.rows.ruris = {other.target, "rcan://robots/c"};
  EXPECT_THAT(Audit(of_fleet), ElementsAre(other)) << "targets";
  of_fleet.rows.ruris.clear();
  of_fleet.action = "robot_block";
  EXPECT_THAT(Audit(of_fleet), SizeIs(2));
}

TEST_P(AccessContract, TextsOfTheAuditAreCleanAndBounded) {
  AuditRow row = Did("x");
  row.who = std::string("a\0b", 3);
  row.detail = std::string(storage::kAuditTextBytesMax - 1, 'd') + "ä";
  ASSERT_TRUE(Access().Append(row).ok());
  ASSERT_THAT(Audit(), SizeIs(1));
  EXPECT_EQ(Audit()[0].who, "a\\x00b");
  EXPECT_EQ(Audit()[0].detail, std::string(storage::kAuditTextBytesMax - 1, 'd'));
}

TEST_P(AccessContract, TheAuditGoesByItsAge) {
  storage::StoreRules rules;
  rules.retain_audit = std::chrono::days(2);
  Fresh(rules);
  ASSERT_TRUE(Access().Append(Did("old")).ok());
  ASSERT_TRUE(Access().Append(Did("new", 5 * kDayMs)).ok());
  ASSERT_TRUE(store_->Process(kProcess).Retain(Time(2 * kDayMs)).ok());
  EXPECT_THAT(Actions(), ElementsAre("new", "old")) << "not one day too old";
  const auto erased = store_->Process(kProcess).Retain(Time(5 * kDayMs));
  ASSERT_TRUE(erased.ok()) << erased.status();
  EXPECT_EQ(erased->rows, 1U);
  EXPECT_THAT(Actions(), ElementsAre("new"));
}

TEST_P(AccessContract, ForgettingARobotTakesItsNotesAndLeavesItsBlock) {
  SettingChange change;
  change.ruri = robot_->ruri;
  change.blocked = true;
  change.registered = true;
  change.labels = {{"a", "1"}};
  change.note = "x";
  Change(change);
  const AccessVersion before = Version();
  store_->RemoveRobot(robot_->ruri);
  ASSERT_THAT(SettingsAfter(before), SizeIs(1)) << "servers learn it";
  const RobotSetting after = SettingsAfter()[0];
  EXPECT_TRUE(after.blocked);
  EXPECT_TRUE(after.registered);
  EXPECT_THAT(after.labels, IsEmpty());
  EXPECT_EQ(after.note, "");
  EXPECT_EQ(after.version, Version());
  store_->RemoveRobot(robot_->ruri);
  EXPECT_EQ(Version(), after.version) << "nothing was left to take";
}

INSTANTIATE_TEST_SUITE_P(Stores, AccessContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
