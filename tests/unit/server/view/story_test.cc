#include "server/view/story.h"

#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/view/story_token.h"
#include "tests/support/exact_json.h"
#include "tests/support/server_world.h"

// One timeline of a robot, merged from the store's lists.
namespace uplink::view {
namespace {

using model::ConnectionEnd;
using model::Presence;
using storage::ListOrder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::string kA = "rcan://a";

class StoryTest : public ::testing::Test {
 protected:
  StoryTest() { world_.AddRobot(kA, "north"); }

  void Pass(int ms = 1) { world_.clock.Advance(milliseconds(ms)); }
  storage::ConnectionItem Connect(std::uint8_t id, const std::string& fleet = "north") {
    storage::ConnectionItem item;
    item.robot = std::make_shared<const model::RobotId>(model::RobotId{kA, fleet});
    item.id = {id};
    item.began_at = world_.clock.System();
    item.address = "192.0.2.1:" + std::to_string(id);
    world_.CommitConnection(item);
    return item;
  }
  void End(storage::ConnectionItem item, ConnectionEnd why) {
    item.ended = storage::ConnectionEnded{
        .at = world_.clock.System(), .why = why, .code = "", .detail = "as it was"};
    world_.CommitConnection(item);
  }
  void Reject(model::RejectReason reason) {
    world_.CommitQuarantine(kA, {reason, "battery", "is 120"}, "bytes");
  }
  void Fault(const std::string& id, bool active) {
    world_.CommitFault(kA, {.unix_time_ms = 1,
                            .fault_id = id,
                            .source = "arm",
                            .severity = model::FaultSeverity::kCritical,
                            .active = active});
  }
  void Mission(const std::string& run, model::MissionStatus status) {
    model::MissionRunStatus report;
    report.mission_id = "m";
    report.run_id = run;
    report.status = status;
    world_.CommitBody(kA, report);
  }
  StoryPage Page(StoryQuery query) {
    query.ruri = kA;
    auto page = world_.queries.Story(query);
    EXPECT_TRUE(page.ok()) << page.status();
    return page.ok() ? *std::move(page) : StoryPage();
  }
  static std::vector<std::string> Kinds(const StoryPage& page) {
    std::vector<std::string> kinds;
    for (const StoryEntry& entry : page.entries) kinds.emplace_back(ToText(entry.place.kind));
    return kinds;
  }
  static std::vector<std::string> Titles(const StoryPage& page) {
    std::vector<std::string> titles;
    for (const StoryEntry& entry : page.entries) titles.push_back(entry.title);
    return titles;
  }
  static boost::json::object Detail(const StoryEntry& entry) {
    return test::ParseExact(entry.detail_json).value_or(boost::json::object());
  }
  /// The whole story by pages of so many entries.
  std::vector<StoryEntry> Walk(ListOrder order, std::uint32_t page_size) {
    std::vector<StoryEntry> walked;
    StoryQuery query{.order = order, .page_size = page_size};
    do {
      StoryPage page = Page(query);
      EXPECT_LE(page.entries.size(), page_size);
      for (StoryEntry& entry : page.entries) walked.push_back(std::move(entry));
      query.page_token = page.next_token;
    } while (!query.page_token.empty() && walked.size() < 1'000);
    return walked;
  }

  testing::ServerWorld world_;
};

TEST_F(StoryTest, TellsWhatHappenedOldestFirstAsItWent) {
  const storage::ConnectionItem first = Connect(1);
  world_.CommitPresence(kA, Presence::kOnline);
  Pass();
  Mission("r", model::MissionStatus::kRunning);
  Pass();
  Fault("E12", true);
  Pass();
  Reject(model::RejectReason::kOutOfRange);
  Pass();
  Mission("r", model::MissionStatus::kError);
  Fault("E12", false);
  Pass();
  End(first, ConnectionEnd::kSilent);
  Pass();
  world_.CommitPresence(kA, Presence::kOffline, ConnectionEnd::kSilent);
  EXPECT_THAT(Titles(Page({.order = ListOrder::kOldestFirst})),
              ElementsAre("The robot connected from 192.0.2.1:1.", "The robot is online.",
                          "Mission m began; by its last report it is error.",
                          "Fault E12 was raised (critical).",
                          "A message was rejected: out_of_range.", "Fault E12 was cleared.",
                          "The connection from 192.0.2.1:1 ended: silent (as it was).",
                          "The robot is offline: its last connection ended as silent."));
}

TEST_F(StoryTest, BeginsWithTheNewestUnlessAskedOtherwise) {
  const storage::ConnectionItem first = Connect(1);
  Pass();
  world_.CommitPresence(kA, Presence::kOnline);
  Pass();
  End(first, ConnectionEnd::kBroken);
  EXPECT_THAT(Kinds(Page({})), ElementsAre("disconnected", "presence", "connected"));
}

TEST_F(StoryTest, AnOpenConnectionHasNoEnd) {
  static_cast<void>(Connect(1));
  EXPECT_THAT(Kinds(Page({})), ElementsAre("connected"));
}

TEST_F(StoryTest, TellsWhatHeldAConnectionBackWithItsEnd) {
  storage::ConnectionItem held = Connect(1);
  held.held_back = milliseconds(12'340);
  held.held_back_why = "flow";
  Pass();
  End(held, ConnectionEnd::kOrderly);
  const StoryPage page = Page({.order = ListOrder::kOldestFirst});
  ASSERT_THAT(Kinds(page), ElementsAre("connected", "held_back", "disconnected"));
  EXPECT_EQ(page.entries[1].title,
            "The server had held the stream back for 12.3 s in all, last for flow.");
  EXPECT_EQ(Detail(page.entries[1]).at("heldBack").at("totalMs").as_string(), "12340");
}

TEST_F(StoryTest, TellsAMoveToAnotherFleet) {
  End(Connect(1, "north"), ConnectionEnd::kOrderly);
  Pass();
  End(Connect(2, "south"), ConnectionEnd::kOrderly);
  const StoryPage page = Page({.order = ListOrder::kOldestFirst});
  ASSERT_THAT(Kinds(page),
              ElementsAre("connected", "disconnected", "connected", "fleet_moved", "disconnected"));
  EXPECT_EQ(page.entries[3].title, "The robot moved from fleet north to fleet south.");
  EXPECT_EQ(Detail(page.entries[3]).at("to").as_string(), "south");
}

TEST_F(StoryTest, RejectsOfOneReasonAreOneEntryUntilSomethingElseHappens) {
  for (int i = 0; i < 3; ++i) {
    Reject(model::RejectReason::kOutOfRange);
    Pass();
    Reject(model::RejectReason::kMalformed);
    Pass();
  }
  world_.CommitPresence(kA, Presence::kOnline);
  Pass();
  Reject(model::RejectReason::kOutOfRange);
  const StoryPage page = Page({.order = ListOrder::kOldestFirst});
  EXPECT_THAT(
      Titles(page),
      ElementsAre("3 messages were rejected: out_of_range.", "3 messages were rejected: malformed.",
                  "The robot is online.", "A message was rejected: out_of_range."));
  const boost::json::object detail = Detail(page.entries[0]);
  EXPECT_EQ(detail.at("count").to_number<std::uint64_t>(), 3U);
  EXPECT_EQ(detail.at("field").as_string(), "battery");
  EXPECT_NE(detail.at("firstAt").as_string(), detail.at("lastAt").as_string());
}

TEST_F(StoryTest, APageEndsAfterSoManyRejects) {
  for (std::size_t i = 0; i <= kStoryRejectsMax; ++i) Reject(model::RejectReason::kOutOfRange);
  const StoryPage page = Page({});
  EXPECT_THAT(Titles(page), ElementsAre("1000 messages were rejected: out_of_range."));
  ASSERT_NE(page.next_token, "");
  const StoryPage rest = Page({.page_token = page.next_token});
  EXPECT_THAT(Titles(rest), ElementsAre("A message was rejected: out_of_range."));
  EXPECT_EQ(rest.next_token, "");
}

TEST_F(StoryTest, AWalkTellsEverythingOnceWhateverItsPagesAndItsOrder) {
  // Several of each kind at one time, and at several.
  for (int round = 0; round < 4; ++round) {
    storage::ConnectionItem one = Connect(static_cast<std::uint8_t>(2 * round + 1));
    static_cast<void>(
        Connect(static_cast<std::uint8_t>(2 * round + 2), round % 2 == 0 ? "south" : "north"));
    world_.CommitPresence(kA, Presence::kOnline);
    world_.CommitPresence(kA, Presence::kOffline);
    Fault("1", true);
    Fault("2", true);
    Mission("r" + std::to_string(round), model::MissionStatus::kRunning);
    Mission("s" + std::to_string(round), model::MissionStatus::kRunning);
    one.held_back = milliseconds(1);
    End(one, ConnectionEnd::kReplaced);
    if (round % 2 == 1) Pass();
  }
  for (const ListOrder order : {ListOrder::kNewestFirst, ListOrder::kOldestFirst}) {
    const StoryPage whole = Page({.order = order, .page_size = storage::kPageSizeMax});
    EXPECT_EQ(whole.next_token, "");
    for (const std::uint32_t page_size : {1U, 2U, 3U, 7U, 100U}) {
      const std::vector<StoryEntry> walked = Walk(order, page_size);
      ASSERT_EQ(walked.size(), whole.entries.size()) << page_size;
      for (std::size_t i = 0; i < walked.size(); ++i) {
        EXPECT_EQ(walked[i].place, whole.entries[i].place) << i << " of pages of " << page_size;
      }
    }
  }
}

TEST_F(StoryTest, AWalkTellsOfEachRejectOnceWhateverItsPages) {
  for (int i = 0; i < 30; ++i) {
    Reject(i % 3 == 0 ? model::RejectReason::kMalformed : model::RejectReason::kOutOfRange);
    if (i % 7 == 0) world_.CommitPresence(kA, i % 2 == 0 ? Presence::kOnline : Presence::kOffline);
    if (i % 4 == 0) Pass();
  }
  for (const ListOrder order : {ListOrder::kNewestFirst, ListOrder::kOldestFirst}) {
    for (const std::uint32_t page_size : {1U, 2U, 5U, 100U}) {
      std::map<std::string, std::uint64_t> counts;
      for (const StoryEntry& entry : Walk(order, page_size)) {
        if (entry.place.kind != StoryKind::kRejected) continue;
        const boost::json::object detail = Detail(entry);
        counts[detail.at("reason").as_string().c_str()] +=
            detail.at("count").to_number<std::uint64_t>();
      }
      EXPECT_THAT(counts, ElementsAre(std::pair("malformed", 10U), std::pair("out_of_range", 20U)))
          << page_size;
    }
  }
}

TEST_F(StoryTest, FromAndToBoundIt) {
  const storage::ConnectionItem one = Connect(1);
  Pass(10);
  const SystemTime middle = world_.clock.System();
  world_.CommitPresence(kA, Presence::kOnline);
  Pass(10);
  End(one, ConnectionEnd::kOrderly);
  EXPECT_THAT(Kinds(Page({.from = middle, .to = middle})), ElementsAre("presence"));
  EXPECT_THAT(Kinds(Page({.from = middle})), ElementsAre("disconnected", "presence"));
  EXPECT_THAT(Kinds(Page({.to = middle})), ElementsAre("presence", "connected"));
}

TEST_F(StoryTest, IsOfThisRobotAlone) {
  world_.AddRobot("rcan://b");
  world_.CommitPresence("rcan://b", Presence::kOnline);
  EXPECT_THAT(Page({}).entries, IsEmpty());
}

TEST_F(StoryTest, HasTheRowsOfTheFleetsThatAreAskedFor) {
  End(Connect(1, "south"), ConnectionEnd::kOrderly);
  Pass();
  Connect(2, "north");
  world_.CommitPresence(kA, Presence::kOnline);
  EXPECT_THAT(Kinds(Page({.fleets = {"north"}})), ElementsAre("presence", "connected"));
  EXPECT_THAT(Kinds(Page({.fleets = {"north", "south"}})),
              ElementsAre("presence", "fleet_moved", "connected", "disconnected", "connected"));
  EXPECT_EQ(world_.queries.Story({.ruri = kA, .fleets = {"south"}}).status(),
            world_.queries.Story({.ruri = kA, .fleets = {"east"}}).status())
      << "it is north's now";
}

TEST_F(StoryTest, ARobotThatIsUnknownAndHasNoEntryIsNotFound) {
  EXPECT_EQ(world_.queries.Story({.ruri = "rcan://x"}).status().code(),
            absl::StatusCode::kNotFound);
}

TEST_F(StoryTest, ItsTokensAreOfOneOrder) {
  for (int i = 0; i < 2; ++i) world_.CommitPresence(kA, Presence::kOnline);
  const std::string good = Page({.page_size = 1}).next_token;
  for (const std::string& token : {std::string("x"), good + "0", "r." + good.substr(2),
                                   good.substr(0, 4) + "99" + good.substr(6),
                                   good.substr(0, 8) + std::string(good.size() - 8, 'z')}) {
    const absl::Status status = world_.queries.Story({.ruri = kA, .page_token = token}).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << token;
    EXPECT_THAT(std::string(status.message()), HasSubstr("pageToken")) << token;
  }
  const absl::Status status =
      world_.queries.Story({.ruri = kA, .order = ListOrder::kOldestFirst, .page_token = good})
          .status();
  EXPECT_THAT(std::string(status.message()), HasSubstr("another order"));
}

TEST(StoryToken, HoldsAPlace) {
  const StoryPlace place{FromUnixMs(1'777'636'800'123), StoryKind::kFault, 77};
  for (const ListOrder order : {ListOrder::kNewestFirst, ListOrder::kOldestFirst}) {
    const auto read = PlaceFromToken(order, StoryToken(order, place));
    ASSERT_TRUE(read.ok()) << read.status();
    EXPECT_EQ(*read, place);
  }
}

}  // namespace
}  // namespace uplink::view
