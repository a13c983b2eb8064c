#include "server/view/queries.h"

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/robot/live_bytes.h"
#include "server/view/messages.h"
#include "server/view/parts.h"
#include "server/view/timestamps.h"
#include "tests/support/server_world.h"

namespace uplink::view {
namespace {

using ::testing::ElementsAre;

std::vector<std::string> Ruris(const RobotsPage& page) {
  std::vector<std::string> ruris;
  for (const RobotView& robot : page.robots) ruris.push_back(robot.id.ruri);
  return ruris;
}

class QueriesTest : public ::testing::Test {
 protected:
  RobotsPage Robots(const RobotsQuery& query) {
    auto page = world_.queries.Robots(query);
    EXPECT_TRUE(page.ok()) << page.status();
    return page.ok() ? *std::move(page) : RobotsPage();
  }

  /// More than a page of them holds.
  testing::ServerWorld world_{100};
};

TEST_F(QueriesTest, WalksRobotsByRuriWithATotal) {
  for (const char* ruri : {"rcan://c", "rcan://a", "rcan://b"}) world_.AddRobot(ruri);
  RobotsQuery query;
  query.page_size = 2;
  const RobotsPage first = Robots(query);
  EXPECT_THAT(Ruris(first), ElementsAre("rcan://a", "rcan://b"));
  EXPECT_EQ(first.total, 3);
  query.page_token = first.next_token;
  const RobotsPage last = Robots(query);
  EXPECT_THAT(Ruris(last), ElementsAre("rcan://c"));
  EXPECT_EQ(last.next_token, "");
  EXPECT_EQ(last.total, 3);
}

TEST_F(QueriesTest, KeepsWhatItWalksWhileRobotsComeAndOthersAsk) {
  std::atomic<bool> ended{false};
  std::jthread other([&] {
    while (!ended) {
      EXPECT_TRUE(world_.queries.Robots({}).ok());
      EXPECT_TRUE(world_.queries.Fleets({}).ok());
    }
  });
  constexpr int kRobots = 90;
  for (int i = 0; i < kRobots; ++i) {
    world_.AddRobot("rcan://r" + std::to_string(i));
    EXPECT_EQ(Robots({}).total, i + 1);
    EXPECT_TRUE(world_.queries.Fleets({}).ok());
  }
  ended = true;
}

TEST_F(QueriesTest, ShowsAGatewayForAsLongAsTheRobotsStreamComesThroughIt) {
  class SilentInbox final : public loop::WakeInbox {
    void Wake(std::uint64_t /*stream*/) override {}
  } inbox;
  robot::RobotSessions& sessions = world_.AddRobot("rcan://a").sessions;
  const loop::StreamRef stream{.inbox = &inbox, .stream = 1};
  static_cast<void>(sessions.Attach(stream, world_.clock.Steady(), world_.clock.System(),
                                    {.gateway = "CN=hall"}));
  const auto shown = [this] { return ToMessage(*world_.queries.Robot("rcan://a", {})).gateway(); };
  EXPECT_EQ(shown(), "CN=hall");
  static_cast<void>(sessions.Detach(stream, world_.clock.Steady()));
  EXPECT_EQ(shown(), "");
}

TEST_F(QueriesTest, ShowsWhatAnotherServerHoldsAsItIsInTheStore) {
  robot::Robot& robot = world_.AddRobot("rcan://a");
  world_.AddRobot("rcan://b");
  world_.CommitPresence("rcan://a", model::Presence::kOnline);
  const storage::OpenRequest open{.robot = robot.id(), .at = world_.clock.System()};
  const auto opened = world_.store.OpenStreams({&open, 1});
  ASSERT_TRUE(opened.ok());
  robot::LiveChanges changes;
  changes.changed.set(static_cast<std::size_t>(storage::LivePart::kUsage));
  changes.parts.usage = model::UsageTelemetry{.unix_time_ms = 5, .reboot_count = 7};
  changes.last_sign_of_life = FromUnixMs(9);
  changes.clock_skew_ms = 3;
  storage::LiveRow row = robot::ToRow("rcan://a", changes);
  row.held_since = opened->front().held_since;
  ASSERT_TRUE(world_.store.Checkpoint({&row, 1}).ok());
  robot.state.FollowHolder({.held_by = "b:2", .written_at = FromUnixMs(8)},
                           {model::Presence::kOnline, FromUnixMs(6)});

  const auto one = world_.queries.Robot("rcan://a", {});
  ASSERT_TRUE(one.ok());
  EXPECT_EQ(one->state.parts.usage->reboot_count, 7U);
  EXPECT_EQ(one->state.last_sign_of_life, FromUnixMs(9));
  EXPECT_EQ(one->state.clock_skew_ms, 3);
  const v1::Robot shown = ToMessage(*one);
  EXPECT_EQ(shown.held_by(), "b:2");
  EXPECT_EQ(view::UnixMs(shown.held_by_at()), 8);
  EXPECT_EQ(shown.presence(), "online");
  EXPECT_EQ(view::UnixMs(shown.presence_since()), 6);

  RobotsQuery query;
  query.parts = PartSet::All();
  const RobotsPage page = Robots(query);
  EXPECT_EQ(page.robots.at(0).state.parts.usage->reboot_count, 7U);
  EXPECT_FALSE(page.robots.at(1).state.foreign.has_value());
  EXPECT_EQ(ToMessage(page.robots.at(1)).held_by(), "");

  world_.reader.SetAway(true);
  query.parts = PartSet::OfLists();
  query.parts.Add(Part::kUsage);
  EXPECT_FALSE(Robots(query).robots.at(0).state.parts.usage) << "the others must be seen";
  EXPECT_EQ(world_.queries.Robot("rcan://a", {})->state.presence, model::Presence::kOnline);
}

TEST_F(QueriesTest, APageOfRobotsThatOthersHoldEndsByWhatTheirPartsHold) {
  constexpr std::size_t kRobots = 72;
  robot::LiveChanges changes;
  changes.changed.set(static_cast<std::size_t>(storage::LivePart::kExtras));
  for (int i = 0; i < 1000; ++i) changes.parts.extras.Put(std::to_string(i), {.value = true});
  ASSERT_GT(kRobots * KeyedBytes(changes.parts), storage::kPageBytesMax);
  for (std::size_t i = 100; i < 100 + kRobots; ++i) {
    const std::string ruri = "rcan://" + std::to_string(i);
    robot::Robot& robot = world_.AddRobot(ruri);
    const storage::OpenRequest open{.robot = robot.id(), .at = world_.clock.System()};
    const auto opened = world_.store.OpenStreams({&open, 1});
    ASSERT_TRUE(opened.ok());
    storage::LiveRow row = robot::ToRow(ruri, changes);
    row.held_since = opened->front().held_since;
    ASSERT_TRUE(world_.store.Checkpoint({&row, 1}).ok());
    robot.state.FollowHolder({.held_by = "b:2", .written_at = FromUnixMs(8)},
                             {model::Presence::kOnline, FromUnixMs(6)});
  }
  RobotsQuery query{.page_size = storage::kPageSizeMax};
  query.parts.Add(Part::kExtras);
  std::size_t listed = 0;
  std::size_t pages = 0;
  do {
    const RobotsPage page = Robots(query);
    std::size_t bytes = 0;
    for (const RobotView& robot : page.robots) {
      EXPECT_EQ(robot.state.parts.extras.items().size(), 1000U) << robot.id.ruri;
      bytes += KeyedBytes(robot.state.parts);
    }
    EXPECT_LT(bytes, storage::kPageBytesMax + KeyedBytes(changes.parts));
    listed += page.robots.size();
    query.page_token = page.next_token;
    ASSERT_LE(++pages, kRobots);
  } while (!query.page_token.empty());
  EXPECT_EQ(listed, kRobots);
  EXPECT_EQ(pages, 2U);
}

TEST_F(QueriesTest, APageThatEndsWithTheLastRobotIsTheLast) {
  world_.AddRobot("rcan://a");
  world_.AddRobot("rcan://b");
  RobotsQuery query;
  query.page_size = 2;
  EXPECT_EQ(Robots(query).next_token, "");
}

TEST_F(QueriesTest, ATokenStaysValidWhileRobotsAreAdded) {
  world_.AddRobot("rcan://b");
  world_.AddRobot("rcan://d");
  RobotsQuery query;
  query.page_size = 1;
  query.page_token = Robots(query).next_token;
  world_.AddRobot("rcan://a");
  world_.AddRobot("rcan://c");
  query.page_size = 10;
  EXPECT_THAT(Ruris(Robots(query)), ElementsAre("rcan://c", "rcan://d"));
}

TEST_F(QueriesTest, FiltersByFleetAndPresence) {
  world_.AddRobot("rcan://a", "north");
  robot::Robot& online = world_.AddRobot("rcan://b", "north");
  world_.AddRobot("rcan://c", "south");
  online.state.SignOfLife(world_.clock.Steady(), world_.clock.System(),
                          world_.fleet.presence_limits());
  RobotsQuery query;
  query.filter.fleets = {"north"};
  EXPECT_THAT(Ruris(Robots(query)), ElementsAre("rcan://a", "rcan://b"));
  query.filter.presence = robot::Presence::kOnline;
  EXPECT_THAT(Ruris(Robots(query)), ElementsAre("rcan://b"));
  query.filter.fleets = {"south"};
  EXPECT_THAT(Ruris(Robots(query)), ElementsAre());
}

TEST_F(QueriesTest, ABadTokenNamesItsField) {
  RobotsQuery query;
  query.page_token = "mine";
  const auto page = world_.queries.Robots(query);
  EXPECT_EQ(page.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_TRUE(page.status().message().rfind("pageToken", 0) == 0) << page.status();
}

TEST_F(QueriesTest, CountsActiveFaultsAndKeepsTheLastCountWhileTheStoreIsAway) {
  world_.AddRobot("rcan://a");
  world_.AddRobot("rcan://b");
  world_.CommitFault("rcan://a",
                     {.unix_time_ms = 1, .fault_id = "f", .source = "s", .active = true});
  EXPECT_EQ(world_.queries.Robot("rcan://a", {})->active_faults, 1);
  EXPECT_EQ(world_.queries.Robot("rcan://b", {})->active_faults, 0);

  world_.reader.SetAway(true);
  EXPECT_EQ(world_.queries.Robot("rcan://a", {})->active_faults, 1);

  world_.reader.SetAway(false);
  world_.CommitFault("rcan://a",
                     {.unix_time_ms = 2, .fault_id = "f", .source = "s", .active = false});
  EXPECT_EQ(world_.queries.Robot("rcan://a", {})->active_faults, 0);
}

TEST_F(QueriesTest, RowsAreUnavailableWhileTheStoreIsAway) {
  world_.AddRobot("rcan://a");
  world_.reader.SetAway(true);
  using storage::Reader;
  const auto code = [this](auto list, const auto& query) {
    return world_.queries.List(list, query).status().code();
  };
  EXPECT_EQ(code(&Reader::FaultsActive, storage::FaultsQuery()), absl::StatusCode::kUnavailable);
  EXPECT_EQ(code(&Reader::FaultHistory, storage::FaultsQuery()), absl::StatusCode::kUnavailable);
  EXPECT_EQ(world_.queries.Quarantine({}, {}).status().code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(code(&Reader::Gaps, storage::HistoryQuery()), absl::StatusCode::kUnavailable);
  EXPECT_EQ(code(&Reader::Events, storage::EventsQuery()), absl::StatusCode::kUnavailable);
  EXPECT_EQ(code(&Reader::Messages, storage::MessagesQuery()), absl::StatusCode::kUnavailable);
  EXPECT_EQ(code(&Reader::PresenceChanges, storage::HistoryQuery()),
            absl::StatusCode::kUnavailable);
  EXPECT_EQ(code(&Reader::MissionRuns, storage::MissionsQuery()), absl::StatusCode::kUnavailable);
  EXPECT_EQ(world_.queries.Shapes({}).status().code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(world_.queries.Objects({}).status().code(), absl::StatusCode::kUnavailable);
}

TEST_F(QueriesTest, ARobotThatWasNeverSeenIsNotFound) {
  EXPECT_EQ(world_.queries.Robot("rcan://x", {}).status().code(), absl::StatusCode::kNotFound);
  const storage::HistoryQuery query{.ruris = {"rcan://x"}};
  const auto gaps = world_.queries.List(&storage::Reader::Gaps, query);
  ASSERT_TRUE(gaps.ok());
  EXPECT_TRUE(gaps->rows.empty()) << "as a filter it matches nothing";
}

TEST_F(QueriesTest, TheAnswerOnARobotThatIsNotHereGivesNoReason) {
  EXPECT_EQ(world_.queries.Robot("rcan://x", {}).status().message(),
            "this server has no robot with the RURI rcan://x now");
}

TEST_F(QueriesTest, NoRobotIsNotFoundWhileTheStoresRobotsAreUnread) {
  world_.robots_unread = true;
  EXPECT_EQ(world_.queries.Robot("rcan://x", {}).status().code(), absl::StatusCode::kUnavailable);
  world_.AddRobot("rcan://x");
  EXPECT_TRUE(world_.queries.Robot("rcan://x", {}).ok());
}

TEST_F(QueriesTest, RowsOfARobotThatLeftMemoryAreThere) {
  const auto gone = std::make_shared<const model::RobotId>(model::RobotId{"rcan://gone", "f"});
  const storage::OpenRequest request{.robot = gone, .at = world_.clock.System()};
  const auto opened = world_.store.OpenStreams({&request, 1});
  ASSERT_TRUE(opened.ok());
  storage::Batch batch;
  batch.presence = {
      {gone, model::Presence::kOffline, world_.clock.System(), 1, opened->front().held_since}};
  ASSERT_TRUE(world_.store.Commit(batch).ok());
  const storage::HistoryQuery query{.ruris = {"rcan://gone"}};
  EXPECT_EQ(world_.queries.List(&storage::Reader::PresenceChanges, query)->rows.size(), 1U);
  EXPECT_EQ(world_.queries.Robot("rcan://gone", {}).status().code(), absl::StatusCode::kNotFound);
}

TEST_F(QueriesTest, StatusHoldsTheConservationTable) {
  metrics::MessageCounts counts;
  counts.received = 5;
  counts.applied = 3;
  counts.stored = 1;
  counts.in_flight = 1;
  world_.ledgers.NewPage().Publish(counts);
  metrics::MessageCounts ignored;
  ignored.received = ignored.ignored = 2;
  world_.ledgers.NewPage(model::MessageSource::kCyberwave).Publish(ignored);
  world_.AddRobot("rcan://a");
  world_.sessions.streams.Add();
  const StatusView status = world_.queries.Status();
  EXPECT_TRUE(status.messages[0].Balanced());
  EXPECT_EQ(status.messages[0].received, 5U);
  EXPECT_TRUE(status.messages[1].Balanced());
  EXPECT_EQ(status.messages[1].ignored, 2U);
  EXPECT_EQ(status.robots.unknown, 1);
  EXPECT_EQ(status.streams, 1);
}

}  // namespace
}  // namespace uplink::view
