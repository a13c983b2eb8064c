#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/base/clock.h"
#include "storage/postgres/parts.h"
#include "tests/support/eventually.h"
#include "tests/support/records.h"
#include "tests/unit/storage/postgres_fixture.h"

// Leases on topics and deliveries where several connections write at once.
namespace uplink::storage::postgres {
namespace {

using ::testing::ElementsAre;

class PostgresDeliveries : public PostgresFixture {
 protected:
  std::unique_ptr<TopicLeases> Leases(std::uint8_t process) {
    auto made = MakeTopicLeases(Options(process), clock_);
    EXPECT_TRUE(made.ok()) << made.status();
    return *std::move(made);
  }
  static TakeRequest Wants(std::string client_id, std::string prefix = "") {
    TakeRequest request;
    request.client_id = std::move(client_id);
    request.prefixes = {std::move(prefix)};
    request.at = FromUnixMs(kNowMs);
    return request;
  }
  static TopicHoldRef Take(TopicLeases& leases, const TakeRequest& request) {
    const auto epoch = leases.Take(request);
    EXPECT_TRUE(epoch.ok() && *epoch) << epoch.status();
    if (!epoch.ok() || !*epoch) return nullptr;
    return std::make_shared<const TopicHold>(TopicHold{request.client_id, **epoch});
  }
  static Batch LostSession(const TopicHoldRef& hold, std::uint64_t number) {
    Batch batch;
    batch.deliveries = {{hold, {{number, 0, std::nullopt}}}};
    return batch;
  }
  /// A commit of process 1 under the lease that stands still with its locks held.
  PostgresShell CommitInPart(const TopicHold& hold, std::uint64_t number) const {
    PostgresShell commit(database_.url());
    commit.Run("BEGIN");
    commit.Run("SELECT uplinkd.hold_topics(ARRAY['" + hold.client_id + "'], ARRAY[" +
               std::to_string(hold.epoch) + "]::bigint[], '01000000-0000-0000-0000-000000000000')");
    commit.Run("INSERT INTO uplinkd.deliveries VALUES ('" + hold.client_id + "', " +
               std::to_string(number) + ", 7, '07000000-0000-0000-0000-000000000000')");
    return commit;
  }
  [[nodiscard]] bool OneWaits() const {
    return testing::Eventually([this] {
      return database_.Shell().Read(
                 "SELECT count(*) FROM pg_stat_activity WHERE wait_event_type = 'Lock'"
                 " AND datname = current_database()") == "1\n";
    });
  }
  [[nodiscard]] std::string Rows() const {
    return database_.Shell().Read(
        "SELECT client_id, number, packet_id FROM uplinkd.deliveries ORDER BY 1, 2");
  }
};

TEST_F(PostgresDeliveries, ACommitThatEndsASessionWaitsForNoOther) {
  const auto store = Store(1);
  const auto hold = Take(*Leases(1), Wants("c"));
  PostgresShell other = CommitInPart(*hold, 1);
  const auto committed = store->Commit(LostSession(hold, 2));
  EXPECT_TRUE(committed.ok()) << committed.status();
  other.Run("COMMIT");
  EXPECT_EQ(Rows(), "c|1|7\nc|2|0\n");
}

TEST_F(PostgresDeliveries, CommitsThatEndSessionsAtOnceDoNotStandInEachOthersWay) {
  constexpr std::uint64_t kCommits = 100;
  const auto leases = Leases(1);
  const auto hold = Take(*leases, Wants("c"));
  const auto write = [&](PostgresStore& store, std::uint64_t first) {
    for (std::uint64_t i = 0; i < kCommits; ++i) {
      Batch batch = LostSession(hold, first + 4 * i);
      batch.deliveries[0].rows.push_back({first + 4 * i + 1, 7, DeliveryDigest{1}});
      const auto committed = store.Commit(batch);
      ASSERT_TRUE(committed.ok()) << committed.status();
    }
  };
  const auto first = Store(1);
  const auto second = Store(1);
  {
    const std::jthread one([&] { write(*first, 1); });
    const std::jthread two([&] { write(*second, 3); });
  }
  const auto memory = leases->MemoryOf("c");
  ASSERT_TRUE(memory.ok()) << memory.status();
  EXPECT_EQ(memory->last_number, 4 * kCommits);
  EXPECT_THAT(memory->known, ElementsAre(Delivery{4 * kCommits, 7, DeliveryDigest{1}}));
}

TEST_F(PostgresDeliveries, WhoTakesALeaseKnowsWhatACommitWroteThatItWaitedFor) {
  const auto store = Store(1);
  const auto mine = Leases(1);
  const auto others = Leases(2);
  const auto hold = Take(*mine, Wants("c"));
  PostgresShell commit = CommitInPart(*hold, 3);
  TakeRequest request = Wants("c");
  request.over = {{ProcessId{1}, 0}};
  std::jthread take([&] { Take(*others, request); });
  ASSERT_TRUE(OneWaits());
  commit.Run("COMMIT");
  take.join();
  const auto memory = others->MemoryOf("c");
  ASSERT_TRUE(memory.ok()) << memory.status();
  EXPECT_THAT(memory->known, ElementsAre(Delivery{4, 7, DeliveryDigest{7}}));
}

TEST_F(PostgresDeliveries, WhatACommitWroteForAClientIdThatGoesMeanwhileGoesToo) {
  const auto store = Store(1);
  const auto leases = Leases(1);
  const auto hold = Take(*leases, Wants("old", "a"));
  ASSERT_TRUE(leases->Release("old").ok());
  PostgresShell commit = CommitInPart(*hold, 1);
  std::jthread take([this] {
    PostgresShell(database_.url())
        .Run(
            "SELECT uplinkd.take_topics('new', ARRAY['b'],"
            " '02000000-0000-0000-0000-000000000000', '{}', '{}', now(), 8, 1)");
  });
  ASSERT_TRUE(OneWaits());
  commit.Run("COMMIT");
  take.join();
  EXPECT_EQ(database_.Shell().Read("SELECT client_id FROM uplinkd.topic_clients"), "new\n");
  EXPECT_EQ(Rows(), "");
}

}  // namespace
}  // namespace uplink::storage::postgres
