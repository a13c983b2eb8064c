#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "storage/bounds.h"
#include "tests/contract/store_contract.h"

/// What did not come by the relay, also what belongs to no robot.
namespace uplink::testing {
namespace {

using model::MessageSource;
using storage::OutcomeKind;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class NoRobotContract : public StoreContract {
 protected:
  static storage::RobotRef Nobody(const std::string& prefix = "local", std::string fleet = "f1") {
    return std::make_shared<const model::RobotId>(
        model::RobotId{storage::NoRobotOf(prefix), std::move(fleet)});
  }
  static storage::CommitRecord On(const std::string& topic, storage::CommitRecord record) {
    record.origin = storage::OriginOf(MessageSource::kCyberwave, topic);
    return record;
  }
  std::vector<storage::QuarantineRow> From(std::optional<MessageSource> source,
                                           storage::HistoryQuery rows = {}) {
    return RowsOf(store_->reader().Quarantine({.rows = std::move(rows), .source = source}));
  }
  static std::vector<std::string> Topics(const std::vector<storage::QuarantineRow>& rows) {
    std::vector<std::string> topics;
    topics.reserve(rows.size());
    for (const storage::QuarantineRow& row : rows) topics.push_back(row.topic);
    return topics;
  }
  /// The fixture's robot, two that a broker's messages belong to, and none.
  void OpenAll() {
    Open();
    OpenAlso({Robot("twin"), Nobody(), Nobody("other")});
  }
};

TEST_P(NoRobotContract, WhatIsRejectedIsListedByWhereItCameFrom) {
  OpenAll();
  Commit({At(1, Bad(1)), At(2, On("cyberwave/twin/T/event", Of(Robot("twin"), Bad(1)))),
          At(3, On("localcyberwave/twin/x/event", Of(Nobody(), Bad(1)))), At(4, Bad(2))});
  EXPECT_THAT(Topics(From(MessageSource::kCyberwave)),
              ElementsAre("localcyberwave/twin/x/event", "cyberwave/twin/T/event"));
  EXPECT_THAT(Topics(From(MessageSource::kUplink)), ElementsAre("", ""));
  EXPECT_THAT(From({}), SizeIs(4));
  const auto rows = From(MessageSource::kCyberwave);
  ASSERT_THAT(rows, SizeIs(2));
  EXPECT_EQ(rows[0].robot, *Nobody());
  EXPECT_EQ(rows[0].source, MessageSource::kCyberwave);
  EXPECT_EQ(rows[0].rejection, BadReason());
  EXPECT_EQ(rows[0].payload, "bad bytes");
  EXPECT_EQ(rows[1].robot, *Robot("twin"));
  EXPECT_EQ(From(MessageSource::kUplink)[0].source, MessageSource::kUplink);
}

TEST_P(NoRobotContract, AWalkThroughOneSourceSeesEachOfItsRowsOnce) {
  OpenAll();
  std::vector<storage::CommitRecord> records;
  for (model::Seq seq = 1; seq <= 7; ++seq) {
    records.push_back(Bad(2 * seq));
    records.push_back(On(std::to_string(seq), Of(Nobody(), Bad(seq))));
  }
  Commit(std::move(records));
  std::vector<std::string> seen;
  storage::QuarantineQuery query{.rows = {.page_size = 3}, .source = MessageSource::kCyberwave};
  do {
    const auto page = store_->reader().Quarantine(query);
    ASSERT_TRUE(page.ok()) << page.status();
    for (const storage::QuarantineRow& row : page->rows) seen.push_back(row.topic);
    query.rows.page_token = page->next_token;
  } while (!query.rows.page_token.empty() && seen.size() < 20);
  EXPECT_THAT(seen, ElementsAre("7", "6", "5", "4", "3", "2", "1"));
}

TEST_P(NoRobotContract, TheOtherFiltersHoldToo) {
  OpenAll();
  OpenAlso({Nobody("south", "f2")});
  Commit({At(1, On("a", Of(Nobody(), Bad(1)))), At(2, On("b", Of(Nobody("south", "f2"), Bad(1)))),
          At(3, On("c", Of(Robot("twin"), Bad(1))))});
  const MessageSource cyberwave = MessageSource::kCyberwave;
  EXPECT_THAT(Topics(From(cyberwave, {.fleets = {"f2"}})), ElementsAre("b"));
  EXPECT_THAT(Topics(From(cyberwave, {.from = Time(2)})), ElementsAre("c", "b"));
  EXPECT_THAT(Topics(From(cyberwave, {.to = Time(2)})), ElementsAre("b", "a"));
  EXPECT_THAT(Topics(From(cyberwave, {.ruris = {Robot("twin")->ruri}})), ElementsAre("c"));
  EXPECT_THAT(From(MessageSource::kUplink, {.ruris = {Robot("twin")->ruri}}), IsEmpty());
}

TEST_P(NoRobotContract, SeveralFleetsAreFoundUnderAnotherFilterToo) {
  OpenAll();
  OpenAlso({Nobody("south", "f2"), Nobody("west", "f3")});
  Commit({At(1, On("a", Of(Nobody(), Bad(1)))), At(2, On("b", Of(Nobody("south", "f2"), Bad(1)))),
          At(3, On("c", Of(Nobody("west", "f3"), Bad(1)))), At(4, Bad(2))});
  EXPECT_THAT(Topics(From(MessageSource::kCyberwave, {.fleets = {"f3", "f1"}})),
              ElementsAre("c", "a"));
  EXPECT_THAT(Topics(From({}, {.fleets = {"f2", "f3", "f4"}})), ElementsAre("c", "b"));
  storage::HistoryQuery query;
  query.fleets.assign(storage::kFleetsMax, "f1");
  EXPECT_THAT(From({}, query), SizeIs(2));
  query.fleets.emplace_back("f1");
  EXPECT_EQ(store_->reader().Quarantine({.rows = query}).status().code(),
            absl::StatusCode::kInvalidArgument);
}

TEST_P(NoRobotContract, ItsRowsAreLeftOutWhereRobotsAloneAreAskedFor) {
  OpenAll();
  const std::string robot = Robot("twin")->ruri;
  Commit({At(1, On("a", Of(Robot("twin"), Bad(1)))), At(2, On("b", Of(Nobody(), Bad(1)))),
          At(3, On("c", Of(Robot("twin"), Bad(2)))), At(4, On("d", Of(Nobody("other"), Bad(1))))});
  storage::HistoryQuery query{.robots_alone = true, .page_size = 1};
  using Fleets = std::vector<std::string>;
  for (const Fleets& fleets : {Fleets{}, Fleets{"f1"}, Fleets{"f1", "f2"}}) {
    query.fleets = fleets;
    query.page_token = "";
    EXPECT_THAT(Topics(From({}, query)), ElementsAre("c"));
    query.page_token = store_->reader().Quarantine({.rows = query})->next_token;
    EXPECT_THAT(Topics(From({}, query)), ElementsAre("a"));
  }
  EXPECT_THAT(Topics(From({}, {.ruris = {robot, Nobody()->ruri}, .robots_alone = true})),
              ElementsAre("c", "a"));
  EXPECT_THAT(From({}, {.ruris = {Nobody()->ruri}, .robots_alone = true}), IsEmpty());
}

TEST_P(NoRobotContract, WhatTheDatabaseRefusesSaysWhereItCameFrom) {
  OpenAll();
  store_->RefuseFault("poison");
  EXPECT_THAT(Commit({On("cyberwave/twin/T/metrics", Of(Robot("twin"), Good(1, Fault("poison")))),
                      On("x", Of(Nobody(), Bad(1)))}),
              ElementsAre(OutcomeKind::kRefused, OutcomeKind::kStored));
  EXPECT_THAT(Topics(From(MessageSource::kCyberwave)),
              ElementsAre("x", "cyberwave/twin/T/metrics"));
}

TEST_P(NoRobotContract, ItIsInNoListOfRobots) {
  OpenAll();
  const auto robots = store_->reader().Robots(100);
  ASSERT_TRUE(robots.ok()) << robots.status();
  EXPECT_THAT(*robots, SizeIs(2));
  EXPECT_EQ(*store_->reader().RobotCount(), 2U);
  if (storage::Leases* const leases = store_->LeasesOf(kOther)) {
    const auto others = leases->RobotsOfOthers("");
    ASSERT_TRUE(others.ok()) << others.status();
    EXPECT_THAT(*others, SizeIs(2));
  }
  if (storage::RobotRemoval* const removal = store_->removal()) {
    const auto silent =
        removal->SilentSince(Time(1'000'000), storage::ProcessId{kProcess}, std::string_view());
    ASSERT_TRUE(silent.ok()) << silent.status();
    EXPECT_THAT(*silent, SizeIs(2));
  }
}

TEST_P(NoRobotContract, ItsNumbersAreWrittenOnceAndItsHoldIsFencedAsARobots) {
  OpenAll();
  const std::vector<storage::CommitRecord> records = {On("x", Of(Nobody(), Bad(1))),
                                                      On("y", Of(Nobody(), Bad(2)))};
  EXPECT_THAT(Commit(records), Each(OutcomeKind::kStored));
  EXPECT_THAT(Commit(records), Each(OutcomeKind::kRefused));
  store_->LoseNextAnswer(kProcess);
  storage::Batch batch;
  batch.records = {On("z", Of(Nobody(), Bad(3)))};
  EXPECT_FALSE(store_->Process(kProcess).Commit(Held(batch)).ok());
  EXPECT_THAT(Commit(batch.records), Each(OutcomeKind::kRefused));
  EXPECT_THAT(Topics(From(MessageSource::kCyberwave)), ElementsAre("z", "y", "x"));

  storage::OpenRequest taken = Request();
  taken.robot = Nobody();
  const auto opened = store_->Process(kOther).OpenStreams({&taken, 1});
  ASSERT_TRUE(opened.ok()) << opened.status();
  EXPECT_THAT(Commit({On("late", Of(Nobody(), Bad(4))), On("mine", Of(Nobody("other"), Bad(1)))}),
              ElementsAre(OutcomeKind::kFenced, OutcomeKind::kStored));
}

TEST_P(NoRobotContract, ItHasBoundsOfItsOwnThatNoHelloHoldsUp) {
  OpenAll();
  constexpr model::Seq kMax = storage::kQuarantineRowsPerRobotMax;
  std::vector<storage::CommitRecord> records;
  for (model::Seq seq = 1; seq <= kMax + 3; ++seq) {
    // Payloads of the last ones, one more than are kept.
    const bool whole = seq > kMax + 2 - storage::kQuarantinePayloadsPerRobotMax;
    records.push_back(On(std::to_string(seq), Of(Nobody(), Bad(seq, whole ? "bytes" : ""))));
  }
  records.push_back(On("kept", Of(Nobody("other"), Bad(1))));
  Commit(std::move(records));
  const storage::HistoryQuery all{.ruris = {Nobody()->ruri}, .page_size = storage::kPageSizeMax};
  std::size_t payloads = 0;
  for (const storage::QuarantineRow& row : From(MessageSource::kCyberwave, all)) {
    if (!row.payload.empty()) ++payloads;
  }
  EXPECT_EQ(payloads, storage::kQuarantinePayloadsPerRobotMax);

  const std::vector<std::string> both = {Nobody()->ruri, Nobody("other")->ruri};
  const auto trimmed = store_->Process(kProcess).TrimQuarantine(both);
  ASSERT_TRUE(trimmed.ok()) << trimmed.status();
  EXPECT_EQ(trimmed->dropped[static_cast<std::size_t>(BadReason().reason)], 3U)
      << "of a session that is kept, and that no Hello confirmed";
  EXPECT_THAT(Topics(From(MessageSource::kCyberwave, {.ruris = {both[1]}})), ElementsAre("kept"));
  const auto dropped = store_->reader().QuarantineDropped(Nobody()->ruri);
  ASSERT_TRUE(dropped.ok()) << dropped.status();
  EXPECT_THAT(*dropped, ElementsAre(storage::DroppedRow{BadReason().reason, 3}));
}

INSTANTIATE_TEST_SUITE_P(Stores, NoRobotContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
