#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "storage/bounds.h"
#include "storage/connection.h"
#include "tests/contract/store_contract.h"

/// Connections of robots: each is one row, from its beginning to its end.
namespace uplink::testing {
namespace {

using model::ConnectionEnd;
using storage::ConnectionItem;
using storage::ConnectionRow;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::int64_t kDayMs = 86'400'000;

class ConnectionsContract : public StoreContract {
 protected:
  ConnectionsContract() { Open(); }

  static storage::ProcessId Process(std::uint8_t number) { return {number}; }
  /// A connection without anything that may be missing.
  ConnectionItem Began(std::uint8_t id, std::int64_t at_ms = 0,
                       std::uint8_t process = kProcess) const {
    ConnectionItem item;
    item.robot = robot_;
    item.id = {0xFF, 0, '\'', id};
    item.began_at = Time(at_ms);
    item.process = Process(process);
    return item;
  }
  static ConnectionItem Ended(ConnectionItem item, std::int64_t at_ms,
                              ConnectionEnd why = ConnectionEnd::kBroken) {
    item.ended = {.at = Time(at_ms), .why = why, .code = "CANCELLED", .detail = "reset by peer"};
    return item;
  }
  void Write(std::vector<ConnectionItem> items, std::uint8_t process = kProcess) {
    storage::Batch batch;
    batch.connections = std::move(items);
    Commit(batch, process);
  }
  std::vector<ConnectionRow> Rows(const storage::ConnectionsQuery& query = {}) {
    return RowsOf(store_->reader().Connections(query));
  }
  std::vector<int> Ids(const storage::ConnectionsQuery& query = {}) {
    std::vector<int> ids;
    for (const ConnectionRow& row : Rows(query)) ids.push_back(row.id[3]);
    return ids;
  }
  static storage::ConnectionsQuery OnlyOpen() { return {.rows = {}, .open = true}; }
  std::size_t End(std::uint8_t process, std::int64_t at_ms) {
    const auto ended = store_->Process(kProcess).EndConnections(Process(process), Time(at_ms));
    EXPECT_TRUE(ended.ok()) << ended.status();
    return ended.value_or(0);
  }
  std::vector<storage::ProcessId> Processes(std::uint8_t asks = kProcess) {
    const auto processes = store_->Process(asks).ProcessesWithOpenConnections();
    EXPECT_TRUE(processes.ok()) << processes.status();
    return processes.value_or(std::vector<storage::ProcessId>());
  }
};

TEST_P(ConnectionsContract, AreReadAsTheyWereWritten) {
  ConnectionItem item = Began(1, 5);
  item.source = model::MessageSource::kUncrew;
  item.server = "server:7443";
  item.address = "192.0.2.1:4711";
  item.gateway = "CN=gateway";
  item.agent_version = "1.2";
  item.certificate = {"0A1B", "ab", "cd", Time(90 * kDayMs)};
  item.messages = 7;
  item.bytes = std::uint64_t{1} << 40U;
  item.takeovers = 2;
  item.held_back = milliseconds(1500);
  item.held_back_why = "journal_full";
  Write({Ended(item, 9, ConnectionEnd::kSilent)});
  ASSERT_THAT(Rows(), SizeIs(1));
  const ConnectionRow row = Rows()[0];
  EXPECT_EQ(row.robot, *robot_);
  EXPECT_EQ(row.id, item.id);
  EXPECT_EQ(row.source, model::MessageSource::kUncrew);
  EXPECT_EQ(row.began_at, Time(5));
  EXPECT_EQ(row.process, Process(kProcess));
  EXPECT_EQ(row.server, "server:7443");
  EXPECT_EQ(row.address, "192.0.2.1:4711");
  EXPECT_EQ(row.gateway, "CN=gateway");
  EXPECT_EQ(row.agent_version, "1.2");
  EXPECT_EQ(row.certificate.serial, "0A1B");
  EXPECT_EQ(row.certificate.sha256, "ab");
  EXPECT_EQ(row.certificate.key_sha256, "cd");
  EXPECT_EQ(row.certificate.not_after, Time(90 * kDayMs));
  EXPECT_EQ(row.messages, 7U);
  EXPECT_EQ(row.bytes, std::uint64_t{1} << 40U);
  EXPECT_EQ(row.takeovers, 2U);
  EXPECT_EQ(row.held_back_ms, 1500);
  EXPECT_EQ(row.held_back_why, "journal_full");
  EXPECT_EQ(row.ended_at, Time(9));
  EXPECT_EQ(row.why, ConnectionEnd::kSilent);
  EXPECT_EQ(row.code, "CANCELLED");
  EXPECT_EQ(row.detail, "reset by peer");
}

TEST_P(ConnectionsContract, AreOpenUntilTheirEnd) {
  ConnectionItem item = Began(1);
  Write({item});
  ASSERT_THAT(Rows(OnlyOpen()), SizeIs(1));
  EXPECT_EQ(Rows()[0].ended_at, std::nullopt);
  EXPECT_EQ(Rows()[0].why, std::nullopt);
  EXPECT_EQ(Rows()[0].certificate.not_after, std::nullopt);
  EXPECT_EQ(Rows()[0].detail, "");
  item.messages = 3;
  item.agent_version = "2";
  Write({item});
  EXPECT_EQ(Rows()[0].messages, 3U);
  EXPECT_EQ(Rows()[0].agent_version, "2");
  item.messages = 4;
  Write({Ended(item, 5)});
  ASSERT_THAT(Rows(), SizeIs(1));
  EXPECT_EQ(Rows()[0].messages, 4U);
  EXPECT_EQ(Rows()[0].why, ConnectionEnd::kBroken);
  EXPECT_THAT(Rows(OnlyOpen()), IsEmpty());
}

TEST_P(ConnectionsContract, KeepTheirEnd) {
  Write({Ended(Began(1), 5)});
  Write({Began(1)});
  Write({Ended(Began(1), 9, ConnectionEnd::kOrderly)});
  Write({Ended(Began(2), 5), Began(2), Ended(Began(2), 9, ConnectionEnd::kOrderly)});
  Write({Began(3), Ended(Began(3), 5)});
  ASSERT_THAT(Rows(), SizeIs(3));
  for (const ConnectionRow& row : Rows()) {
    EXPECT_EQ(row.ended_at, Time(5));
    EXPECT_EQ(row.why, ConnectionEnd::kBroken);
  }
}

TEST_P(ConnectionsContract, AreWrittenOnceThoughTheAnswerIsLost) {
  storage::Batch batch;
  batch.connections = {Began(1), Ended(Began(2), 5)};
  store_->LoseNextAnswer(kProcess);
  EXPECT_FALSE(store_->Process(kProcess).Commit(batch).ok());
  Commit(batch);
  EXPECT_THAT(Ids(), ElementsAre(2, 1));
  EXPECT_THAT(Ids(OnlyOpen()), ElementsAre(1));
}

TEST_P(ConnectionsContract, AreFoundByRobotFleetAndTime) {
  Fresh();
  ConnectionItem other = Began(2, 2);
  other.robot = Robot("b", "f1");
  ConnectionItem of_other_fleet = Began(3, 3);
  of_other_fleet.robot = Robot("c", "f2");
  Write({Ended(Began(1, 1), 9), other, of_other_fleet});
  EXPECT_THAT(Ids(), ElementsAre(3, 2, 1));
  EXPECT_THAT(Ids({.rows = {.ruris = {robot_->ruri}}}), ElementsAre(1));
  EXPECT_THAT(Ids({.rows = {.ruris = {robot_->ruri}}, .open = true}), IsEmpty());
  EXPECT_THAT(Ids({.rows = {.fleets = {"f1"}}}), ElementsAre(2, 1));
  EXPECT_THAT(Ids({.rows = {.fleets = {"f1"}}, .open = true}), ElementsAre(2));
  EXPECT_THAT(Ids(OnlyOpen()), ElementsAre(3, 2));
  storage::ConnectionsQuery query;
  query.rows.from = Time(2);
  query.rows.to = Time(2);
  EXPECT_THAT(Ids(query), ElementsAre(2));
  query = {};
  query.rows.ruris = {robot_->ruri, of_other_fleet.robot->ruri};
  query.rows.order = storage::ListOrder::kOldestFirst;
  EXPECT_THAT(Ids(query), ElementsAre(1, 3));
  query = {};
  query.rows.page_size = 2;
  query.rows.page_token = store_->reader().Connections(query)->next_token;
  EXPECT_THAT(Ids(query), ElementsAre(1));
}

TEST_P(ConnectionsContract, AreFoundBySourceAndEnd) {
  ConnectionItem drone = Began(3, 3);
  drone.source = model::MessageSource::kUncrew;
  Write({Ended(Began(1, 1), 9), Ended(Began(2, 2), 9, ConnectionEnd::kSilent),
         Ended(drone, 9, ConnectionEnd::kSilent), Began(4, 4)});
  EXPECT_THAT(Ids({.rows = {}, .why = ConnectionEnd::kSilent}), ElementsAre(3, 2));
  EXPECT_THAT(Ids({.rows = {}, .why = ConnectionEnd::kOrderly}), IsEmpty()) << "nor open ones";
  EXPECT_THAT(Ids({.rows = {}, .open = true, .why = ConnectionEnd::kBroken}), IsEmpty());
  EXPECT_THAT(Ids({.rows = {}, .source = model::MessageSource::kUncrew}), ElementsAre(3));
  const auto uplink = model::MessageSource::kUplink;
  EXPECT_THAT(Ids({.rows = {}, .source = uplink}), ElementsAre(4, 2, 1));
  EXPECT_THAT(Ids({.rows = {}, .open = true, .source = uplink}), ElementsAre(4));
  EXPECT_THAT(Ids({.rows = {.fleets = {robot_->fleet}}, .why = ConnectionEnd::kSilent}),
              ElementsAre(3, 2));
  EXPECT_THAT(
      Ids({.rows = {.ruris = {robot_->ruri}}, .source = uplink, .why = ConnectionEnd::kSilent}),
      ElementsAre(2));
}

TEST_P(ConnectionsContract, NeedNoHold) {
  Write({Began(1)});
  Open(Request(), kOther);
  Write({Ended(Began(1), 5)});
  EXPECT_EQ(Rows()[0].why, ConnectionEnd::kBroken) << "the robot moved, and the past is told";
}

TEST_P(ConnectionsContract, OfARobotWithoutARowAreDropped) {
  ConnectionItem stranger = Began(2);
  stranger.robot = Robot("stranger");
  Write({Began(1), stranger});
  EXPECT_THAT(Ids(), ElementsAre(1));
  store_->RemoveRobot(robot_->ruri);
  EXPECT_THAT(Rows(), IsEmpty()) << "they go with their robot";
  Write({Ended(Began(1), 5)});
  EXPECT_THAT(Rows(), IsEmpty()) << "and do not come back";
}

TEST_P(ConnectionsContract, AreTheLastOfARobot) {
  constexpr auto kMax = static_cast<std::uint8_t>(storage::kConnectionsPerRobotMax);
  Fresh();
  ConnectionItem other = Began(200);
  other.robot = Robot("b");
  std::vector<ConnectionItem> items = {other};
  for (std::uint8_t id = 0; id < kMax; ++id) items.push_back(Began(id, 1 + id));
  Write(items);
  EXPECT_THAT(Ids(), SizeIs(kMax + 1)) << "at the bound";
  Write({Began(kMax, 1 + kMax), Began(kMax + 1, 2 + kMax)});
  storage::ConnectionsQuery query{.rows = {.ruris = {robot_->ruri}}};
  ASSERT_THAT(Ids(query), SizeIs(kMax));
  EXPECT_EQ(Ids(query).front(), kMax + 1);
  EXPECT_EQ(Ids(query).back(), 2);
  Write({Ended(Began(0, 1), 500)});
  EXPECT_EQ(Ids(query).back(), 2) << "one that went does not come back";
  EXPECT_THAT(Ids({.rows = {.ruris = {other.robot->ruri}}}), ElementsAre(200));
}

TEST_P(ConnectionsContract, AreTheLastThoughTheClockWasAhead) {
  constexpr auto kMax = static_cast<std::uint8_t>(storage::kConnectionsPerRobotMax);
  constexpr std::int64_t kHourMs = 3'600'000;
  std::vector<ConnectionItem> ahead;
  for (std::uint8_t id = 0; id < kMax; ++id) {
    ahead.push_back(Ended(Began(id, kHourMs + id), kHourMs + 100));
  }
  Write(ahead);
  Write({Began(kMax, 1)});
  EXPECT_THAT(Ids(OnlyOpen()), ElementsAre(kMax)) << "the clock is right again";
  ASSERT_THAT(Rows(), SizeIs(kMax));
  Write({Ended(Began(kMax, 1), 2), Began(kMax + 1, 3)});
  const std::vector<int> ids = Ids();
  ASSERT_THAT(ids, SizeIs(kMax));
  EXPECT_THAT(std::vector<int>(ids.end() - 3, ids.end()), ElementsAre(2, kMax + 1, kMax))
      << "those written first went";
}

TEST_P(ConnectionsContract, AreKeptWhileOpenBeforeEndedOnes) {
  constexpr auto kMax = static_cast<std::uint8_t>(storage::kConnectionsPerRobotMax);
  Write({Began(0)});
  std::vector<ConnectionItem> others;
  for (std::uint8_t id = 1; id <= kMax; ++id) others.push_back(Ended(Began(id, id), 100));
  Write(others);
  EXPECT_THAT(Ids(), SizeIs(kMax));
  EXPECT_THAT(Ids(OnlyOpen()), ElementsAre(0)) << "the first written of all";
  EXPECT_EQ(Ids()[kMax - 2], 2);
  for (ConnectionItem& item : others) {
    item = Began(static_cast<std::uint8_t>(item.id[3] + kMax), item.id[3]);
  }
  Write(others);
  EXPECT_THAT(Ids(OnlyOpen()), SizeIs(kMax));
  EXPECT_EQ(Ids(OnlyOpen()).back(), kMax + 1) << "of open ones, too, the first written goes";
}

TEST_P(ConnectionsContract, GoByTheirAgeOnceTheyHaveEnded) {
  storage::StoreRules rules;
  rules.retain_connections = std::chrono::days(2);
  Fresh(rules);
  Write({Ended(Began(1, 0), 1), Began(2, 0), Ended(Began(3, 0), 5 * kDayMs)});
  ASSERT_TRUE(store_->Process(kProcess).Retain(Time(2 * kDayMs)).ok());
  EXPECT_THAT(Ids(), SizeIs(3)) << "not one day too old";
  const auto erased = store_->Process(kProcess).Retain(Time(5 * kDayMs));
  ASSERT_TRUE(erased.ok()) << erased.status();
  EXPECT_EQ(erased->rows, 1U);
  EXPECT_THAT(Ids(), ElementsAre(3, 2));
  rules.retain_connections = milliseconds(0);
  Fresh(rules);
  Write({Ended(Began(1, 0), 1)});
  const auto kept = store_->Process(kProcess).Retain(Time(200 * kDayMs));
  ASSERT_TRUE(kept.ok()) << kept.status();
  EXPECT_THAT(Ids(), SizeIs(1)) << "zero: for ever";
}

TEST_P(ConnectionsContract, AreEndedForAProcessThatIsOver) {
  Write({Began(1, 0), Began(2, 9), Ended(Began(3, 0), 1)});
  Write({Began(4, 0, kOther)}, kOther);
  EXPECT_THAT(Processes(), ElementsAre(Process(kOther)));
  EXPECT_THAT(Processes(kOther), ElementsAre(Process(kProcess)));
  EXPECT_EQ(End(kProcess, 5), 2U);
  EXPECT_EQ(End(kProcess, 6), 0U);
  EXPECT_THAT(Ids(OnlyOpen()), ElementsAre(4));
  EXPECT_THAT(Processes(kOther), IsEmpty());
  for (const ConnectionRow& row : Rows()) {
    if (row.id[3] == 4 || row.id[3] == 3) continue;
    EXPECT_EQ(row.why, ConnectionEnd::kServerEnded);
    EXPECT_EQ(row.code, "");
    EXPECT_EQ(row.detail, storage::kServerEndedDetail);
    EXPECT_EQ(row.ended_at, Time(row.id[3] == 1 ? 5 : 9)) << "never before it began";
  }
}

TEST_P(ConnectionsContract, ThatOthersEndedGoOnByTheWordOfTheirOwnProcess) {
  ConnectionItem item = Began(1);
  Write({item});
  EXPECT_EQ(End(kProcess, 5), 1U);
  Write({Began(1, 0, kOther)}, kOther);
  EXPECT_EQ(Rows()[0].why, ConnectionEnd::kServerEnded) << "another's word";
  item.messages = 7;
  Write({item});
  ASSERT_THAT(Ids(OnlyOpen()), ElementsAre(1)) << "the process only stood still";
  EXPECT_EQ(Rows()[0].messages, 7U);
  EXPECT_EQ(Rows()[0].ended_at, std::nullopt);
  EXPECT_EQ(Rows()[0].why, std::nullopt);
  EXPECT_EQ(Rows()[0].detail, "");
  EXPECT_THAT(Processes(kOther), ElementsAre(Process(kProcess)));
  EXPECT_EQ(End(kProcess, 6), 1U) << "and then it died";
  EXPECT_EQ(Rows()[0].ended_at, Time(6));
}

TEST_P(ConnectionsContract, KeepTheEndThatTheirOwnProcessToldThoughTheServerEnded) {
  Write({Ended(Began(1), 5, ConnectionEnd::kServerEnded)});
  Write({Began(1)});
  Write({Ended(Began(2), 5, ConnectionEnd::kServerEnded), Began(2)});
  EXPECT_THAT(Rows(), SizeIs(2));
  EXPECT_THAT(Ids(OnlyOpen()), IsEmpty());
}

TEST_P(ConnectionsContract, ThatOthersEndedStillTakeTheirOwnEnd) {
  Write({Began(1)});
  EXPECT_EQ(End(kProcess, 5), 1U);
  Write({Ended(Began(1), 9, ConnectionEnd::kOrderly)});
  EXPECT_EQ(Rows()[0].why, ConnectionEnd::kOrderly);
  EXPECT_EQ(Rows()[0].ended_at, Time(9));
}

TEST_P(ConnectionsContract, AreEndedWhenTheLeaseWasRenewedLast) {
  storage::Leases* const leases = store_->LeasesOf(kOther);
  Write({Began(1, 0, kOther)}, kOther);
  const bool by_lease = leases != nullptr && std::string_view(GetParam().name) != "Fake";
  if (by_lease) {
    ASSERT_TRUE(leases->Renew({.name = "b", .life = "2"}).ok());
  }
  EXPECT_EQ(End(kOther, 5), 1U);
  // A lease is renewed by the database's clock, and the suite's is years behind.
  EXPECT_EQ(*Rows()[0].ended_at > Time(100 * kDayMs), by_lease);
}

TEST_P(ConnectionsContract, NameSoManyProcessesAtMost) {
  std::vector<ConnectionItem> items;
  std::vector<storage::RobotRef> robots;
  constexpr auto kMore = static_cast<std::uint8_t>(storage::kOpenProcessesMax + 2);
  for (std::uint8_t number = 0; number < kMore; ++number) {
    items.push_back(Began(number, number, 100 + number));
    items.back().robot = Robot("r" + std::to_string(number % 3));
    robots.push_back(items.back().robot);
  }
  robots.resize(3);
  OpenAlso(robots);
  Write(items);
  const auto named = Processes();
  ASSERT_THAT(named, SizeIs(storage::kOpenProcessesMax));
  EXPECT_EQ(named.front(), Process(100));
}

TEST_P(ConnectionsContract, AreBoundedPerEnding) {
  std::vector<storage::RobotRef> robots;
  std::vector<ConnectionItem> items;
  for (std::size_t i = 0; i < storage::kSweepRowsMax + 3; ++i) {
    if (i % storage::kConnectionsPerRobotMax == 0) {
      robots.push_back(Robot("r" + std::to_string(i)));
    }
    items.push_back(Began(static_cast<std::uint8_t>(i % storage::kConnectionsPerRobotMax)));
    items.back().robot = robots.back();
  }
  OpenAlso(robots);
  Write(items);
  EXPECT_EQ(End(kProcess, 5), storage::kSweepRowsMax);
  EXPECT_EQ(End(kProcess, 5), 3U);
}

TEST_P(ConnectionsContract, GiveThePresenceItsReason) {
  storage::Batch batch;
  batch.presence_session = model::SessionId({0xEE});
  batch.presence = {
      {robot_, model::Presence::kOnline, Time(1), 1, held_since_},
      {robot_, model::Presence::kOffline, Time(2), 2, held_since_, ConnectionEnd::kSilent}};
  Commit(batch);
  ASSERT_THAT(Changes(), SizeIs(2));
  EXPECT_EQ(Changes()[0].why, ConnectionEnd::kSilent);
  EXPECT_EQ(Changes()[1].why, std::nullopt);
}

INSTANTIATE_TEST_SUITE_P(Stores, ConnectionsContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
