#include <array>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include <gmock/gmock.h>

#include "storage/page_token.h"
#include "tests/contract/store_contract.h"
#include "tests/unit/schema/samples.h"

/// What every list of a durable kind does alike.
namespace uplink::testing {
namespace {

using storage::HistoryQuery;
using storage::Page;
using storage::PageKind;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;

/// A row of any list: the item of the test that it is, and its robot.
struct Seen {
  int item = 0;
  model::RobotId robot;
};

struct List {
  PageKind kind;
  /// What becomes row `item`; of lists without one, Put knows.
  std::function<model::Body(int item)> body;
  std::function<absl::StatusOr<Page<Seen>>(storage::Reader& reader, const HistoryQuery& query)>
      read;
};

template <typename Row, typename ItemOf>
absl::StatusOr<Page<Seen>> SeenOf(absl::StatusOr<Page<Row>> page, const ItemOf& item_of) {
  if (!page.ok()) return page.status();
  Page<Seen> seen;
  seen.next_token = page->next_token;
  seen.positions = page->positions;
  for (const Row& row : page->rows) seen.rows.push_back({item_of(row), row.robot});
  return seen;
}

model::MissionRunStatus Report(int item) {
  model::MissionRunStatus report;
  report.run_id = std::to_string(item);
  return report;
}

constexpr auto kRunItem = [](const auto& row) { return std::stoi(row.run_id); };

List EventList() {
  return {PageKind::kEvents,
          [](int item) {
            return model::EventTelemetry{item, model::EstopEngagedEvent{}};
          },
          [](storage::Reader& reader, const HistoryQuery& query) {
            return SeenOf(reader.Events({.rows = query}),
                          [](const auto& row) { return static_cast<int>(row.sampled_at_ms); });
          }};
}

List MessageList() {
  return {PageKind::kMessages,
          [](int item) {
            return model::Message{0, model::MessageLevel::kInfo, std::to_string(item)};
          },
          [](storage::Reader& reader, const HistoryQuery& query) {
            return SeenOf(reader.Messages({.rows = query}),
                          [](const auto& row) { return std::stoi(row.message.message); });
          }};
}

List RunList() {
  return {PageKind::kMissionRuns, Report, [](storage::Reader& reader, const HistoryQuery& query) {
            return SeenOf(reader.MissionRuns({.rows = query}), kRunItem);
          }};
}

List ReportList() {
  return {PageKind::kMissionReports, Report,
          [](storage::Reader& reader, const HistoryQuery& query) {
            return SeenOf(reader.MissionReports({.rows = query}), kRunItem);
          }};
}

List ShapeList() {
  return {PageKind::kShapes,
          [](int item) {
            model::ReportedShape shape = test::SampleShape();
            shape.identity.id = std::to_string(item);
            return model::ShapeOp{shape};
          },
          [](storage::Reader& reader, const HistoryQuery& query) {
            return SeenOf(reader.Shapes({query, {}, false}),
                          [](const auto& row) { return std::stoi(row.identity.id); });
          }};
}

List ObjectList() {
  return {PageKind::kObjects,
          [](int item) {
            model::Object object = test::SampleObject();
            object.id = std::to_string(item);
            return model::ObjectOp{object};
          },
          [](storage::Reader& reader, const HistoryQuery& query) {
            return SeenOf(reader.Objects({query, {}, false}),
                          [](const auto& row) { return std::stoi(row.id); });
          }};
}

class ListContract : public StoreContract {
 protected:
  /// Three items share each time; a change of presence is told from others of its time by what it
  /// changed to.
  static constexpr int kItemsAtOneTime = 3;
  /// Items of a walk: six pages of 4, and one.
  static constexpr int kItems = 25;

  static List PresenceList() {
    return {PageKind::kPresenceChanges, nullptr,
            [](storage::Reader& reader, const HistoryQuery& query) {
              return SeenOf(reader.PresenceChanges(query), [](const storage::PresenceRow& row) {
                return static_cast<int>(UnixMs(row.at) - kNowMs) * kItemsAtOneTime +
                       static_cast<int>(row.presence);
              });
            }};
  }

  static List FaultList(PageKind kind,
                        storage::ListOfReader<storage::FaultRow, storage::FaultsQuery> read) {
    return {kind, [](int item) { return Fault(std::to_string(item)); },
            [read](storage::Reader& reader, const HistoryQuery& query) {
              return SeenOf((reader.*read)({.rows = query}),
                            [](const auto& row) { return std::stoi(row.fault.fault_id); });
            }};
  }

  static List QuarantineList() {
    return {PageKind::kQuarantine, nullptr, [](storage::Reader& reader, const HistoryQuery& query) {
              return SeenOf(reader.Quarantine({.rows = query}),
                            [](const auto& row) { return std::stoi(row.payload); });
            }};
  }

  static List GapList() {
    return {PageKind::kGaps, nullptr, [](storage::Reader& reader, const HistoryQuery& query) {
              return SeenOf(reader.Gaps(query),
                            [](const auto& row) { return static_cast<int>(row.first / 2); });
            }};
  }

  static List RequestList() {
    return {PageKind::kOperatorRequests, nullptr,
            [](storage::Reader& reader, const HistoryQuery& query) {
              return SeenOf(reader.OperatorRequests({.rows = query}),
                            [](const auto& row) { return std::stoi(row.request_id); });
            }};
  }

  static List ConnectionList() {
    return {PageKind::kConnections, nullptr,
            [](storage::Reader& reader, const HistoryQuery& query) {
              return SeenOf(reader.Connections({.rows = query}),
                            [](const auto& row) { return 256 * row.id[0] + row.id[1]; });
            }};
  }

  void ForEachList(const std::function<void(const List& list)>& test) {
    const std::array lists = {FaultList(PageKind::kFaultHistory, &storage::Reader::FaultHistory),
                              FaultList(PageKind::kFaultsActive, &storage::Reader::FaultsActive),
                              QuarantineList(),
                              GapList(),
                              EventList(),
                              MessageList(),
                              RunList(),
                              ReportList(),
                              ShapeList(),
                              ObjectList(),
                              PresenceList(),
                              RequestList(),
                              ConnectionList()};
    for (const List& list : lists) {
      SCOPED_TRACE(static_cast<int>(list.kind));
      Fresh();
      numbers_ = 0;
      test(list);
    }
  }

  void Put(const List& list, int item, storage::RobotRef robot) {
    const std::int64_t after_ms = item / kItemsAtOneTime;
    storage::Batch batch;
    if (list.body) {
      batch.records = {At(after_ms, Of(std::move(robot), Good(++numbers_, list.body(item))))};
    } else if (list.kind == PageKind::kQuarantine) {
      storage::CommitRecord bad = Bad(++numbers_, std::to_string(item));
      batch.records = {At(after_ms, Of(std::move(robot), std::move(bad)))};
    } else if (list.kind == PageKind::kOperatorRequests) {
      batch.records = {At(after_ms, Asks(item, std::move(robot)))};
    } else if (list.kind == PageKind::kGaps) {
      const auto first = 2 * static_cast<model::Seq>(item) + 1;
      batch.gaps = {Gap(first, first)};
      batch.gaps[0].robot = std::move(robot);
      batch.gaps[0].seen_at = Time(after_ms);
    } else if (list.kind == PageKind::kConnections) {
      storage::ConnectionItem connection;
      connection.robot = std::move(robot);
      connection.id = {static_cast<std::uint8_t>(item / 256),
                       static_cast<std::uint8_t>(item % 256)};
      connection.began_at = Time(after_ms);
      batch.connections = {connection};
    } else {
      batch.presence = {{std::move(robot), static_cast<model::Presence>(item % kItemsAtOneTime),
                         Time(after_ms), ++numbers_, held_since_}};
    }
    Commit(batch);
  }
  void Put(const List& list, int item) { Put(list, item, robot_); }

  /// A drone's request to its operator.
  storage::CommitRecord Asks(int item, storage::RobotRef robot) {
    const storage::ClaimRequest request{robot, Time()};
    const auto claimed = store_->Process(kProcess).ClaimDrones({&request, 1});
    EXPECT_TRUE(claimed.ok()) << claimed.status();
    storage::SampleMark mark;
    mark.claim = claimed->front().claim;
    mark.digest[0] = static_cast<std::uint8_t>(item);
    storage::CommitRecord asks = Of(std::move(robot), Good(++numbers_));
    asks.content = model::OperatorRequest{.request_id = std::to_string(item), .open = true};
    asks.sample = std::make_shared<const storage::SampleMark>(mark);
    return asks;
  }

  std::vector<int> ItemsOf(const List& list, const HistoryQuery& query = {}) {
    std::vector<int> items;
    for (const Seen& row : RowsOf(list.read(store_->reader(), query))) items.push_back(row.item);
    return items;
  }

  model::Seq numbers_ = 0;
};

TEST_P(ListContract, RunsFromTheNewestArrivalAndAmongEqualsFromTheLastWritten) {
  ForEachList([this](const List& list) {
    for (const int item : {3, 9, 0, 5, 4, 6}) Put(list, item);
    EXPECT_THAT(ItemsOf(list), ElementsAre(9, 6, 4, 5, 3, 0));
  });
}

TEST_P(ListContract, GivesRowsOfOneRobotFleetAndTime) {
  ForEachList([this](const List& list) {
    Put(list, 0, Robot("a", "f1"));
    Put(list, 3, Robot("b", "f1"));
    Put(list, 6, Robot("c", "f2"));
    Put(list, 9, Robot("a", "f1"));
    const auto items = [&](const std::string& ruri, const std::string& fleet,
                           std::optional<std::int64_t> from, std::optional<std::int64_t> to) {
      HistoryQuery query;
      if (!ruri.empty()) query.ruris = {ruri};
      if (!fleet.empty()) query.fleets = {fleet};
      if (from) query.from = Time(*from);
      if (to) query.to = Time(*to);
      return ItemsOf(list, query);
    };
    const std::string a = "rcan://robots/a";
    EXPECT_THAT(items(a, "", {}, {}), ElementsAre(9, 0));
    EXPECT_THAT(items("", "f1", {}, {}), ElementsAre(9, 3, 0));
    EXPECT_THAT(items("", "f2", {}, {}), ElementsAre(6));
    EXPECT_THAT(items(a, "f2", {}, {}), IsEmpty());
    EXPECT_THAT(items("rcan://robots", "", {}, {}), IsEmpty());
    EXPECT_THAT(items("", "", 1, 2), ElementsAre(6, 3)) << "both ends belong to it";
    EXPECT_THAT(items("", "", 3, {}), ElementsAre(9));
    EXPECT_THAT(items("", "", 4, {}), IsEmpty());
    EXPECT_THAT(items("", "", {}, 0), ElementsAre(0));
    EXPECT_THAT(items("", "", {}, -1), IsEmpty());
    EXPECT_THAT(items("", "", 2, 1), IsEmpty());
    EXPECT_THAT(items(a, "", 1, 3), ElementsAre(9));
    EXPECT_THAT(items("", "f1", 0, 2), ElementsAre(3, 0));
    EXPECT_THAT(items(a, "f1", 0, 3), ElementsAre(9, 0));
  });
}

TEST_P(ListContract, IsWalkedOnceWhileRowsAreAdded) {
  ForEachList([this](const List& list) {
    for (int item = 0; item < kItems; ++item) Put(list, item, Robot(item % 2 == 0 ? "a" : "b"));
    std::map<int, int> seen;
    HistoryQuery query;
    query.page_size = 4;
    int pages = 0;
    do {
      const auto page = list.read(store_->reader(), query);
      ASSERT_TRUE(page.ok()) << page.status();
      for (const Seen& row : page->rows) ++seen[row.item];
      query.page_token = page->next_token;
      // Newer rows; the first lies at a time that the walk has begun with.
      Put(list, kItems - 1 + kItemsAtOneTime * pages, Robot("c"));
      ++pages;
    } while (!query.page_token.empty() && pages < kItems);
    EXPECT_EQ(pages, 7);
    EXPECT_THAT(seen, SizeIs(kItems));
    for (const auto& [item, times] : seen) EXPECT_EQ(times, 1) << item;
  });
}

TEST_P(ListContract, GoesOnBehindEachRowByItsPosition) {
  ForEachList([this](const List& list) {
    for (int item = 0; item < kItems; ++item) Put(list, item);
    for (const auto order : {storage::ListOrder::kNewestFirst, storage::ListOrder::kOldestFirst}) {
      HistoryQuery query{.order = order};
      const std::vector<int> all = ItemsOf(list, query);
      const auto page = list.read(store_->reader(), query);
      ASSERT_EQ(page->positions.size(), page->rows.size());
      for (std::size_t row = 0; row < all.size(); row += 5) {
        query.page_token = EncodePageToken(list.kind, order, page->positions[row]);
        const std::vector<int> rest(all.begin() + static_cast<std::ptrdiff_t>(row) + 1, all.end());
        EXPECT_EQ(ItemsOf(list, query), rest) << row;
      }
    }
  });
}

TEST_P(ListContract, PagesWhatAFilterLeaves) {
  ForEachList([this](const List& list) {
    for (int item = 0; item < 12; ++item) {
      Put(list, item, item % 2 == 0 ? Robot("a", "f1") : Robot("b", "f2"));
    }
    for (const bool by_fleet : {false, true}) {
      HistoryQuery query;
      if (by_fleet) {
        query.fleets = {"f1"};
      } else {
        query.ruris = {"rcan://robots/a"};
      }
      query.from = Time(1);
      query.page_size = 2;
      EXPECT_THAT(ItemsOf(list, query), ElementsAre(10, 8));
      query.page_token = list.read(store_->reader(), query)->next_token;
      EXPECT_THAT(ItemsOf(list, query), ElementsAre(6, 4)) << "item 4 is the last from Time(1) on";
      EXPECT_EQ(list.read(store_->reader(), query)->next_token, "");
    }
  });
}

TEST_P(ListContract, RunsFromTheOldestArrivalIfThatIsAsked) {
  ForEachList([this](const List& list) {
    for (const int item : {3, 9, 0, 5, 4, 6}) Put(list, item);
    HistoryQuery query;
    query.order = storage::ListOrder::kOldestFirst;
    EXPECT_THAT(ItemsOf(list, query), ElementsAre(0, 3, 5, 4, 6, 9));
    query.from = Time(1);
    query.to = Time(2);
    EXPECT_THAT(ItemsOf(list, query), ElementsAre(3, 5, 4, 6));
  });
}

TEST_P(ListContract, IsWalkedFromTheOldestOnAndSeesWhatIsAdded) {
  ForEachList([this](const List& list) {
    for (int item = 0; item < 12; ++item) Put(list, item, Robot(item % 2 == 0 ? "a" : "b"));
    std::vector<int> seen;
    HistoryQuery query;
    query.order = storage::ListOrder::kOldestFirst;
    query.page_size = 5;
    do {
      const auto page = list.read(store_->reader(), query);
      ASSERT_TRUE(page.ok()) << page.status();
      if (seen.empty()) Put(list, 12, Robot("c"));
      for (const Seen& row : page->rows) seen.push_back(row.item);
      query.page_token = page->next_token;
    } while (!query.page_token.empty() && seen.size() <= 13);
    EXPECT_THAT(seen, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12));
  });
}

TEST_P(ListContract, MergesTheRowsOfSeveralRobots) {
  ForEachList([this](const List& list) {
    for (int item = 0; item < 12; ++item) {
      Put(list, item, Robot(std::string(1, "abc"[item % 3]), item % 3 == 0 ? "f1" : "f2"));
    }
    HistoryQuery query;
    // Named twice, and one that has nothing.
    query.ruris = {"rcan://robots/c", "rcan://robots/a", "rcan://robots/c", "rcan://robots/x"};
    EXPECT_THAT(ItemsOf(list, query), ElementsAre(11, 9, 8, 6, 5, 3, 2, 0));
    query.page_size = 3;
    EXPECT_THAT(ItemsOf(list, query), ElementsAre(11, 9, 8));
    query.page_token = list.read(store_->reader(), query)->next_token;
    EXPECT_THAT(ItemsOf(list, query), ElementsAre(6, 5, 3));
    query.page_token.clear();
    query.fleets = {"f1"};
    EXPECT_THAT(ItemsOf(list, query), ElementsAre(9, 6, 3));
    query.order = storage::ListOrder::kOldestFirst;
    query.from = Time(1);
    EXPECT_THAT(ItemsOf(list, query), ElementsAre(3, 6, 9));
    query.ruris.assign(storage::kRurisMax, "rcan://robots/a");
    EXPECT_THAT(ItemsOf(list, query), ElementsAre(3, 6, 9));
    query.ruris.emplace_back("rcan://robots/a");
    EXPECT_EQ(list.read(store_->reader(), query).status().code(),
              absl::StatusCode::kInvalidArgument);
  });
}

TEST_P(ListContract, MergesTheRowsOfSeveralFleets) {
  ForEachList([this](const List& list) {
    for (int item = 0; item < 12; ++item) {
      Put(list, item, Robot(std::string(1, "abc"[item % 3]), std::string(1, "fgh"[item % 3])));
    }
    // One named twice, and one that has nothing.
    HistoryQuery query{.fleets = {"h", "f", "h", "x"}, .page_size = 3};
    EXPECT_THAT(ItemsOf(list, query), ElementsAre(11, 9, 8));
    query.page_token = list.read(store_->reader(), query)->next_token;
    EXPECT_THAT(ItemsOf(list, query), ElementsAre(6, 5, 3));
    query.ruris = {"rcan://robots/b", "rcan://robots/c"};
    EXPECT_THAT(ItemsOf(list, query), ElementsAre(5, 2));
  });
}

TEST_P(ListContract, GivesNoTokenWithAFullLastPage) {
  ForEachList([this](const List& list) {
    EXPECT_EQ(list.read(store_->reader(), {})->next_token, "");
    Put(list, 0);
    Put(list, 1);
    HistoryQuery query;
    query.page_size = 2;
    const auto page = list.read(store_->reader(), query);
    EXPECT_THAT(page->rows, SizeIs(2));
    EXPECT_EQ(page->next_token, "");
  });
}

TEST_P(ListContract, RefusesOtherTokensAndSizes) {
  ForEachList([this](const List& list) {
    const auto refused = [&](const HistoryQuery& query) {
      const absl::Status status = list.read(store_->reader(), query).status();
      EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
      return std::string(status.message());
    };
    Put(list, 0);
    Put(list, 1);
    HistoryQuery query;
    query.page_size = 1;
    const std::string good = list.read(store_->reader(), query)->next_token;
    std::string changed = good;
    changed[10] = changed[10] == '0' ? '1' : '0';
    const PageKind other = list.kind == PageKind::kGaps ? PageKind::kQuarantine : PageKind::kGaps;
    for (const std::string& token :
         {std::string("x"), std::string(good.size(), 'z'), good + "0", good.substr(1), changed,
          std::string(1, '\0'), std::string(100'000, '0'),
          EncodePageToken(other, query.order, {Time(), 7}),
          EncodePageToken(list.kind, storage::ListOrder::kOldestFirst, {Time(), 7})}) {
      query.page_token = token;
      EXPECT_THAT(refused(query), StartsWith("pageToken")) << token.substr(0, 100);
    }
    query.page_token = good;
    EXPECT_THAT(ItemsOf(list, query), ElementsAre(0));
    query.page_token = "";
    for (const std::uint32_t size : {0U, storage::kPageSizeMax + 1}) {
      query.page_size = size;
      EXPECT_THAT(refused(query), StartsWith("pageSize"));
    }
    for (const std::uint32_t size : {1U, storage::kPageSizeMax}) {
      query.page_size = size;
      EXPECT_TRUE(list.read(store_->reader(), query).ok());
    }
  });
}

TEST_P(ListContract, HoldsWhatWasThereBeforeAReopening) {
  ForEachList([this](const List& list) {
    for (const int item : {1, 2}) Put(list, item);
    store_->Reopen();
    EXPECT_THAT(ItemsOf(list), ElementsAre(2, 1));
    Put(list, 0);
    EXPECT_THAT(ItemsOf(list), ElementsAre(0, 2, 1)) << "written last of one time";
  });
}

TEST_P(ListContract, AFaultThatIsReportedAgainKeepsItsPlaceInAWalk) {
  const List active = FaultList(PageKind::kFaultsActive, &storage::Reader::FaultsActive);
  Fresh();
  for (const int item : {0, 3, 6}) Put(active, item);
  HistoryQuery query;
  query.page_size = 2;
  EXPECT_THAT(ItemsOf(active, query), ElementsAre(6, 3));
  query.page_token = active.read(store_->reader(), query)->next_token;
  Commit({At(100, Good(++numbers_, Fault("0")))});
  EXPECT_THAT(ItemsOf(active, query), ElementsAre(0));
}

INSTANTIATE_TEST_SUITE_P(Stores, ListContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
