#include "storage/decide.h"

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/bounds.h"
#include "storage/expiry.h"
#include "storage/refusal.h"
#include "tests/support/records.h"

namespace uplink::storage {
namespace {

using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr std::int64_t kNowMs = 1'763'683'200'000;
constexpr std::int64_t kNever = 0;

/// What a store knows, in memory. Counts which questions were asked.
class PlainKnown final : public Known {
 public:
  using Entry = std::tuple<PresentKind, std::string, std::string, std::string>;

  absl::StatusOr<KnownRobot*> Robot(std::string_view ruri) override {
    if (!failure.ok()) return failure;
    const auto robot = robots.find(ruri);
    return robot == robots.end() ? nullptr : &robot->second;
  }
  absl::StatusOr<KnownSession*> Session(const CommitRecord& record) override {
    asked.emplace_back("session");
    return &sessions[{record.robot->ruri, record.session}];
  }
  absl::StatusOr<std::optional<model::Rejection>> Rejected(const CommitRecord& record) override {
    asked.emplace_back("rejected");
    const auto why = rejected.find(record.seq);
    if (why == rejected.end()) return std::optional<model::Rejection>();
    return std::optional(why->second);
  }
  absl::StatusOr<KnownSamples*> Samples(const CommitRecord& record) override {
    asked.emplace_back("samples");
    return &samples[record.sample->type];
  }
  absl::StatusOr<KnownRobot::RequestIds> OpenRequests(std::string_view /*ruri*/) override {
    asked.emplace_back("requests");
    return open_requests;
  }
  absl::StatusOr<Epoch> LeaseEpoch(std::string_view client_id) override {
    if (!failure.ok()) return failure;
    const auto lease = leases.find(client_id);
    return lease == leases.end() ? Epoch{0} : lease->second;
  }
  absl::StatusOr<std::optional<std::int64_t>> ExpiryOf(const PresentKey& key) override {
    const auto entry = entries.find(EntryOf(key));
    if (entry == entries.end()) return std::optional<std::int64_t>();
    return std::optional(entry->second);
  }
  absl::StatusOr<std::size_t> Count(PresentKind kind, std::string_view ruri) override {
    asked.emplace_back("count");
    std::size_t count = more[kind];
    for (const auto& [entry, expires_ms] : entries) {
      if (std::get<0>(entry) == kind && std::get<1>(entry) == ruri) ++count;
    }
    return count;
  }
  absl::Status Delete(const PresentKey& key) override {
    asked.emplace_back("delete");
    entries.erase(EntryOf(key));
    return absl::OkStatus();
  }
  absl::StatusOr<std::size_t> DeleteExpired(PresentKind kind, std::string_view ruri,
                                            std::int64_t now_ms) override {
    asked.emplace_back("delete expired");
    return std::erase_if(entries, [&](const auto& entry) {
      return std::get<0>(entry.first) == kind && std::get<1>(entry.first) == ruri &&
             IsExpired(entry.second, now_ms);
    });
  }

  static Entry EntryOf(const PresentKey& key) {
    return {key.kind, std::string(key.ruri), std::string(key.id), std::string(key.source)};
  }

  absl::Status failure;
  std::map<std::string, Epoch, std::less<>> leases;
  std::map<std::string, KnownRobot, std::less<>> robots;
  std::map<std::pair<std::string, model::SessionId>, KnownSession> sessions;
  std::map<std::uint32_t, KnownSamples> samples;
  KnownRobot::RequestIds open_requests;
  std::map<model::Seq, model::Rejection> rejected;
  std::map<Entry, std::int64_t> entries;
  /// Entries of a kind that count and stand nowhere.
  std::map<PresentKind, std::size_t> more;
  std::vector<std::string> asked;
};

class Decide : public ::testing::Test {
 protected:
  Decide() { known_.robots["rcan://r"].held_since = 1; }

  CommitRecord Good(model::Seq seq, const model::Body& body) const {
    return {robot_, {}, seq, 1, FromUnixMs(kNowMs), test::RecordOf(body), "bytes", 5};
  }
  CommitRecord Note(model::Seq seq) const {
    model::Message message;
    message.message = "hello";
    return Good(seq, message);
  }
  /// The outcome's kind; kStored for a record that is new and passes, as a store would write it.
  OutcomeKind Kind(const CommitRecord& record) {
    const auto earlier = decider_.Look(record);
    EXPECT_TRUE(earlier.ok()) << earlier.status();
    if (earlier->has_value()) return (*earlier)->kind;
    const auto ruling = decider_.Judge(record);
    EXPECT_TRUE(ruling.ok()) << ruling.status();
    return ruling->refusal ? OutcomeKind::kRefused : OutcomeKind::kStored;
  }

  const RobotRef robot_ = std::make_shared<const model::RobotId>(model::RobotId{"rcan://r", "f"});
  const StoreRules rules_{};
  PlainKnown known_;
  Decider decider_{known_, rules_};
};

TEST_F(Decide, FencesWhateverComesOfARobotThatTheStoreDoesNotKnow) {
  known_.robots.clear();
  EXPECT_EQ(Kind(Note(1)), OutcomeKind::kFenced);
  EXPECT_FALSE(*decider_.Takes({robot_, {}, 1, 2, 1, FromUnixMs(kNowMs)}));
  KnownSession session;
  EXPECT_EQ(*decider_.Decide({robot_, model::Presence::kOnline, FromUnixMs(kNowMs), 1, 3}, session),
            OutcomeKind::kFenced);
  EXPECT_THAT(known_.asked, IsEmpty());
  EXPECT_THAT(known_.robots, IsEmpty()) << "and makes none";
}

TEST_F(Decide, FencesARecordOfAnOlderHoldAndLooksAtNothingOfIt) {
  known_.robots["rcan://r"].held_since = 2;
  EXPECT_EQ(Kind(Note(1)), OutcomeKind::kFenced);
  EXPECT_THAT(known_.asked, IsEmpty());
  CommitRecord current = Note(1);
  current.held_since = 2;
  EXPECT_EQ(Kind(current), OutcomeKind::kStored);
}

TEST_F(Decide, FencesWhatNamesALaterHoldThanTheStoreHas) {
  known_.robots["rcan://r"].held_since = 2;
  CommitRecord later = Note(1);
  later.held_since = 3;
  EXPECT_EQ(Kind(later), OutcomeKind::kFenced);
  EXPECT_FALSE(*decider_.Takes({robot_, {}, 1, 2, 3, FromUnixMs(kNowMs)}));
  KnownSession session;
  const PresenceItem item{robot_, model::Presence::kOnline, FromUnixMs(kNowMs), 1, 3};
  EXPECT_EQ(*decider_.Decide(item, session), OutcomeKind::kFenced);
}

TEST_F(Decide, TakesAGapOfTheHoldAndDropsOneOfAnOlderHold) {
  GapItem gap{robot_, {}, 1, 2, 1, FromUnixMs(kNowMs)};
  EXPECT_TRUE(*decider_.Takes(gap));
  known_.robots["rcan://r"].held_since = 2;
  EXPECT_FALSE(*decider_.Takes(gap));
  gap.held_since = 2;
  EXPECT_TRUE(*decider_.Takes(gap));
}

TEST_F(Decide, LetsTheHolderAloneChangeThePresence) {
  KnownSession session;
  PresenceItem item{robot_, model::Presence::kOnline, FromUnixMs(kNowMs), 1, 3};
  EXPECT_EQ(*decider_.Decide(item, session), OutcomeKind::kFenced) << "it is not held since then";
  item.held_since = 1;
  EXPECT_EQ(*decider_.Decide(item, session), OutcomeKind::kStored);
  EXPECT_EQ(session.cursor, 1U);
  EXPECT_EQ(*decider_.Decide(item, session), OutcomeKind::kDuplicate);
  known_.robots["rcan://r"].held_since = 4;
  item.number = 2;
  EXPECT_EQ(*decider_.Decide(item, session), OutcomeKind::kFenced);
  EXPECT_EQ(session.cursor, 1U) << "it leaves the number to the next";
  item.held_since = 4;
  EXPECT_EQ(*decider_.Decide(item, session), OutcomeKind::kStored);
}

TEST_F(Decide, FindsADuplicateAtAndBelowTheCursor) {
  known_.sessions[{"rcan://r", {}}].cursor = 5;
  EXPECT_EQ(Kind(Note(4)), OutcomeKind::kDuplicate);
  EXPECT_EQ(Kind(Note(5)), OutcomeKind::kDuplicate);
  EXPECT_EQ(Kind(Note(6)), OutcomeKind::kStored);
  EXPECT_EQ(Kind(Note(6)), OutcomeKind::kDuplicate) << "the second copy within the batch";
  EXPECT_EQ(Kind(Note(9)), OutcomeKind::kStored) << "what is skipped is not waited for";
}

TEST_F(Decide, RefusesAgainWhatLiesInQuarantineWithItsReason) {
  known_.sessions[{"rcan://r", {}}].cursor = 5;
  known_.rejected[4] = TooManyShapes();
  const auto outcome = decider_.Look(Note(4));
  ASSERT_TRUE(outcome.ok() && outcome->has_value());
  EXPECT_EQ((*outcome)->kind, OutcomeKind::kRefused);
  EXPECT_EQ((*outcome)->rejection, TooManyShapes());
}

TEST_F(Decide, HoldsNumberZeroForADuplicateAndDoesNotAskWhy) {
  EXPECT_EQ(Kind(Note(0)), OutcomeKind::kDuplicate);
  EXPECT_THAT(known_.asked, Not(Contains("rejected")));
}

TEST_F(Decide, RaisesTheCursorAndRemembersTheLatestArrival) {
  CommitRecord late = Note(1);
  late.received_at = FromUnixMs(kNowMs + 7);
  EXPECT_EQ(Kind(late), OutcomeKind::kStored);
  EXPECT_EQ(Kind(Note(2)), OutcomeKind::kStored);
  const KnownSession& session = known_.sessions[{"rcan://r", {}}];
  EXPECT_EQ(session.cursor, 2U);
  EXPECT_TRUE(session.is_raised);
  EXPECT_EQ(session.last_used, FromUnixMs(kNowMs + 7));
}

TEST_F(Decide, LeavesASessionThatIsNotRaisedAlone) {
  known_.sessions[{"rcan://r", {}}].cursor = 5;
  EXPECT_EQ(Kind(Note(5)), OutcomeKind::kDuplicate);
  EXPECT_FALSE((known_.sessions[{"rcan://r", {}}].is_raised));
}

/// A record of a sample under claim 5.
CommitRecord Sampled(CommitRecord record, std::uint8_t content) {
  record.held_since = 0;
  record.sample = std::make_shared<const SampleMark>(SampleMark{5, 2, {content}, true, false, "x"});
  return record;
}

TEST_F(Decide, GoesByTheClaimForASampleOfARobotThatAnotherHolds) {
  KnownRobot& robot = known_.robots["rcan://r"];
  robot.held_since.reset();
  // They live at once, as those of a batch do: a sample is told apart by its mark's address.
  const std::array records{Sampled(Note(1), 1), Sampled(Note(1), 1), Sampled(Note(1), 1)};
  EXPECT_EQ(Kind(records[0]), OutcomeKind::kFenced) << "it is not claimed";
  robot.claim = 4;
  EXPECT_EQ(Kind(records[1]), OutcomeKind::kFenced);
  EXPECT_THAT(known_.asked, IsEmpty());
  robot.claim = 5;
  EXPECT_EQ(Kind(records[2]), OutcomeKind::kStored);
  EXPECT_EQ(Kind(Note(1)), OutcomeKind::kFenced) << "a claim is no hold";
  EXPECT_THAT(known_.sessions, IsEmpty());
}

TEST_F(Decide, GoesOnWithinASampleAsItsFirstRecordsWereDecided) {
  known_.robots["rcan://r"].claim = 5;
  const CommitRecord record = Sampled(Note(1), 1);
  decider_.ResumeSample(record, {OutcomeKind::kRefused, TooManyShapes()});
  EXPECT_EQ(Kind(record), OutcomeKind::kStored);
  decider_.ResumeSample(record, {OutcomeKind::kDuplicate, std::nullopt});
  EXPECT_EQ(Kind(record), OutcomeKind::kDuplicate);
  EXPECT_THAT(known_.samples, IsEmpty());
  EXPECT_EQ(Kind(Sampled(Note(2), 2)), OutcomeKind::kStored) << "another sample is looked at";
}

TEST_F(Decide, HandsOnAnErrorOfTheStore) {
  known_.failure = absl::UnavailableError("away");
  EXPECT_EQ(decider_.Look(Note(1)).status(), known_.failure);
  EXPECT_EQ(decider_.Takes({robot_, {}, 1, 2, 1, {}}).status(), known_.failure);
  KnownSession session;
  EXPECT_EQ(decider_.Decide(PresenceItem{.robot = robot_}, session).status(), known_.failure);
}

TEST_F(Decide, BoundsNothingOfAKindThatIsHistoryAlone) {
  const auto ruling = decider_.Judge(Note(1));
  ASSERT_TRUE(ruling.ok());
  EXPECT_FALSE(ruling->refusal);
  EXPECT_FALSE(ruling->change);
}

/// A kind that is bounded to so many entries a robot.
struct Bounded {
  std::string name;
  PresentKind kind;
  std::size_t entries_max;
  model::Rejection (*refusal)();
  model::Body (*upsert)(const std::string& id, std::int64_t expires_ms);
  model::Body (*removal)(const std::string& id);
};

model::Fault FaultOf(const std::string& id, bool active) {
  return {.unix_time_ms = kNowMs, .fault_id = id, .active = active};
}

model::Body ShapeOf(const std::string& id, std::int64_t expires_ms) {
  model::ReportedShape shape;
  shape.identity.id = id;
  shape.data = model::GeoPoint2{8, 47};
  shape.expire_time_ms = expires_ms;
  return model::ShapeOp{shape};
}

model::Body ObjectOf(const std::string& id, std::int64_t expires_ms) {
  model::Object object;
  object.id = id;
  object.expires_unix_time_ms = expires_ms;
  return model::ObjectOp{object};
}

const Bounded kFaults = {"faults",
                         PresentKind::kFault,
                         kActiveFaultsPerRobotMax,
                         TooManyActiveFaults,
                         [](const std::string& id, std::int64_t /*expires_ms*/) -> model::Body {
                           return FaultOf(id, true);
                         },
                         [](const std::string& id) -> model::Body { return FaultOf(id, false); }};
const Bounded kShapes = {
    "shapes",
    PresentKind::kShape,
    kShapesPerRobotMax,
    TooManyShapes,
    ShapeOf,
    [](const std::string& id) -> model::Body { return model::ShapeOp{model::Deletion{id}}; }};
const Bounded kObjects = {
    "objects",
    PresentKind::kObject,
    kObjectsPerRobotMax,
    TooManyObjects,
    ObjectOf,
    [](const std::string& id) -> model::Body { return model::ObjectOp{model::Deletion{id}}; }};

TEST_F(Decide, WhatCameUnderALeaseThatIsOverIsFencedAndNotLookedAt) {
  known_.leases["c"] = 5;
  const auto under = [this](const char* client_id, Epoch epoch) {
    CommitRecord record = Note(1);
    record.origin = OriginOf(model::MessageSource::kCyberwave, "t",
                             std::make_shared<const TopicHold>(TopicHold{client_id, epoch}));
    return record;
  };
  EXPECT_EQ(Kind(under("c", 4)), OutcomeKind::kFenced);
  EXPECT_EQ(Kind(under("c", 6)), OutcomeKind::kFenced);
  EXPECT_EQ(Kind(under("unknown", 5)), OutcomeKind::kFenced);
  EXPECT_THAT(known_.asked, IsEmpty());
  EXPECT_EQ(Kind(under("c", 5)), OutcomeKind::kStored);
  Batch batch;
  batch.deliveries = {{under("c", 4).origin->hold, {{1, 7, std::nullopt}}},
                      {under("c", 5).origin->hold, {{2, 7, std::nullopt}}}};
  const auto remembered = decider_.Remember(batch, {});
  ASSERT_TRUE(remembered.ok()) << remembered.status();
  ASSERT_EQ(remembered->added.size(), 1U);
  EXPECT_EQ(remembered->added[0].delivery.number, 2U);
  known_.failure = absl::UnavailableError("away");
  EXPECT_EQ(decider_.Look(under("c", 5)).status(), known_.failure);
  EXPECT_EQ(decider_.Remember(batch, {}).status(), known_.failure);
}

class DecideBound : public Decide, public ::testing::WithParamInterface<Bounded> {
 protected:
  Ruling Judged(const model::Body& body, std::int64_t after_ms = 0) {
    CommitRecord record = Good(1, body);
    record.received_at += milliseconds(after_ms);
    auto ruling = decider_.Judge(record);
    EXPECT_TRUE(ruling.ok()) << ruling.status();
    if (!ruling->refusal && ruling->change) Write(*ruling->change);
    return *std::move(ruling);
  }
  Ruling Upsert(const std::string& id, std::int64_t expires_ms = kNever,
                std::int64_t after_ms = 0) {
    return Judged(GetParam().upsert(id, expires_ms), after_ms);
  }
  Ruling Remove(const std::string& id) { return Judged(GetParam().removal(id)); }
  /// Leaves room for so many.
  void LeaveRoom(std::size_t entries) {
    known_.more[GetParam().kind] = GetParam().entries_max - entries;
  }
  bool Has(const std::string& id) const {
    return known_.entries.contains({GetParam().kind, "rcan://r", id, ""});
  }

 private:
  void Write(const PresentChange& change) {
    if (change.is_upsert) {
      known_.entries[PlainKnown::EntryOf(change.key)] = change.expires_ms;
    } else {
      known_.entries.erase(PlainKnown::EntryOf(change.key));
    }
  }
};

INSTANTIATE_TEST_SUITE_P(All, DecideBound, ::testing::Values(kFaults, kShapes, kObjects),
                         [](const auto& of) { return of.param.name; });

TEST_P(DecideBound, LetsAnEntryPassAtTheBoundAndRefusesOneMore) {
  LeaveRoom(1);
  EXPECT_FALSE(Upsert("last").refusal);
  const Ruling past = Upsert("past");
  ASSERT_TRUE(past.refusal);
  EXPECT_EQ(*past.refusal, GetParam().refusal());
  EXPECT_FALSE(Has("past"));
}

TEST_P(DecideBound, AlwaysLetsAnUpdateAndARemovalPass) {
  LeaveRoom(1);
  EXPECT_FALSE(Upsert("there").was_present);
  const Ruling update = Upsert("there");
  EXPECT_FALSE(update.refusal);
  EXPECT_TRUE(update.was_present);
  EXPECT_TRUE(Remove("there").was_present);
  EXPECT_FALSE(Remove("there").was_present);
}

TEST_P(DecideBound, GivesTheRoomOfARemovedEntryToANewOne) {
  LeaveRoom(1);
  EXPECT_FALSE(Upsert("first").refusal);
  EXPECT_TRUE(Upsert("second").refusal);
  Remove("first");
  EXPECT_FALSE(Upsert("second").refusal);
  EXPECT_TRUE(Upsert("third").refusal);
}

TEST_P(DecideBound, CountsAnEntryThatWentBeforeTheFirstNewOneAsked) {
  LeaveRoom(1);
  known_.entries[{GetParam().kind, "rcan://r", "old", ""}] = kNever;
  Remove("old");
  EXPECT_FALSE(Upsert("new").refusal);
  EXPECT_TRUE(Upsert("past").refusal);
}

TEST_P(DecideBound, CountsOncePerBatchAndOnlyForANewEntry) {
  Remove("none");
  known_.entries[{GetParam().kind, "rcan://r", "there", ""}] = kNever;
  Upsert("there");
  EXPECT_THAT(known_.asked, Not(Contains("count")));
  Upsert("a");
  Upsert("b");
  EXPECT_EQ(std::ranges::count(known_.asked, "count"), 1);
}

TEST_P(DecideBound, CountsARobotForItself) {
  LeaveRoom(0);
  EXPECT_TRUE(Upsert("here").refusal);
  known_.more[GetParam().kind] = 0;
  CommitRecord other = Good(1, GetParam().upsert("there", kNever));
  other.robot = std::make_shared<const model::RobotId>(model::RobotId{"rcan://s", "f"});
  known_.robots["rcan://s"].held_since = 1;
  EXPECT_FALSE(decider_.Judge(other)->refusal);
}

class DecideExpiring : public DecideBound {};

INSTANTIATE_TEST_SUITE_P(All, DecideExpiring, ::testing::Values(kShapes, kObjects),
                         [](const auto& of) { return of.param.name; });

TEST_P(DecideExpiring, MakesRoomOfAllThatHasExpiredOnceTheBoundIsMet) {
  LeaveRoom(2);
  EXPECT_FALSE(Upsert("short", kNowMs + 10).refusal);
  EXPECT_FALSE(Upsert("long", kNowMs + 20).refusal);
  EXPECT_TRUE(Upsert("new", kNever, 9).refusal) << "nothing has expired yet";
  EXPECT_FALSE(Upsert("new", kNever, 10).refusal);
  EXPECT_FALSE(Has("short"));
  EXPECT_TRUE(Has("long"));
  EXPECT_TRUE(Upsert("past", kNever, 10).refusal);
}

TEST_P(DecideExpiring, LeavesExpiredEntriesWhileThereIsRoom) {
  LeaveRoom(2);
  EXPECT_FALSE(Upsert("short", kNowMs + 10).refusal);
  EXPECT_FALSE(Upsert("new", kNever, 10).refusal);
  EXPECT_TRUE(Has("short"));
}

TEST_P(DecideExpiring, BeginsAnewWithAnIdThatHasExpired) {
  LeaveRoom(1);
  EXPECT_FALSE(Upsert("one", kNowMs + 10).refusal);
  EXPECT_THAT(known_.asked, Not(Contains("delete")));
  const Ruling again = Upsert("one", kNever, 10);
  EXPECT_FALSE(again.refusal);
  EXPECT_THAT(known_.asked, Contains("delete"));
  EXPECT_TRUE(Upsert("past", kNever, 10).refusal) << "it counts once";
}

TEST_F(Decide, KeepsFaultsOfTwoSourcesApartAndNeverExpiresThem) {
  known_.more[PresentKind::kFault] = kActiveFaultsPerRobotMax;
  known_.entries[{PresentKind::kFault, "rcan://r", "hot", "drive"}] = kNever;
  model::Fault fault = FaultOf("hot", true);
  fault.source = "drive";
  EXPECT_EQ(Kind(Good(1, fault)), OutcomeKind::kStored);
  fault.source = "arm";
  EXPECT_EQ(Kind(Good(2, fault)), OutcomeKind::kRefused);
  EXPECT_THAT(known_.asked, Not(Contains("delete expired")));
}

TEST_F(Decide, CountsTheConfiguredLifeOfAnObjectThatNamesNoExpiry) {
  const auto ruling = decider_.Judge(Good(1, ObjectOf("o", 0)));
  EXPECT_EQ(ruling->change->expires_ms, kNowMs + rules_.object_ttl.count());
  EXPECT_EQ(decider_.Judge(Good(2, ShapeOf("s", 0)))->change->expires_ms, kNever);
}

}  // namespace
}  // namespace uplink::storage
