// What operators of several servers decide at once, in one database.
#include <atomic>
#include <cstddef>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "storage/postgres/parts.h"
#include "tests/support/eventually.h"
#include "tests/unit/storage/postgres_fixture.h"

namespace uplink::storage::postgres {
namespace {

class PostgresAccessTest : public PostgresFixture {
 protected:
  PostgresAccessTest() { Store(); }

  std::unique_ptr<AccessStore> Access() { return *MakeAccessStore(Options(), clock_); }

  static AuditRow Did() {
    AuditRow row;
    row.at = FromUnixMs(kNowMs);
    row.who = "t-1";
    return row;
  }
};

TEST_F(PostgresAccessTest, WhoFollowsVersionsMissesNoneOfWhatSeveralServersChange) {
  constexpr std::size_t kWriters = 3;
  constexpr std::size_t kEach = 30;
  std::atomic<std::size_t> at_work = kWriters;
  std::vector<std::jthread> writers;
  for (std::size_t writer = 0; writer < kWriters; ++writer) {
    writers.emplace_back([&, writer] {
      const auto access = Access();
      for (std::size_t i = 0; i < kEach; ++i) {
        Revocation revocation;
        revocation.value = std::to_string(writer) + "-" + std::to_string(i);
        EXPECT_TRUE(access->Revoke(revocation, Did()).ok());
      }
      --at_work;
    });
  }
  const auto follower = Access();
  AccessVersion seen = 0;
  std::set<std::string> values;
  bool last = false;
  while (!last) {
    last = at_work == 0;
    const auto newer = follower->RevocationsAfter(seen);
    ASSERT_TRUE(newer.ok()) << newer.status();
    for (const Revocation& one : *newer) {
      EXPECT_GT(one.version, seen);
      seen = one.version;
      values.insert(one.value);
    }
  }
  EXPECT_EQ(values.size(), kWriters * kEach);
  EXPECT_EQ(*follower->Version(), seen);
}

TEST_F(PostgresAccessTest, ChangesOfOneRobotByTwoServersBothStay) {
  constexpr int kEach = 8;
  std::vector<std::jthread> writers;
  for (const std::string& name : std::vector<std::string>{"a", "b"}) {
    writers.emplace_back([&, name] {
      const auto access = Access();
      for (int i = 0; i < kEach; ++i) {
        SettingChange change;
        change.ruri = robot_->ruri;
        change.labels = {{name + std::to_string(i), "x"}};
        EXPECT_TRUE(access->Change(change, Did()).ok());
      }
    });
  }
  writers.clear();
  const auto settings = Access()->SettingsAfter(0);
  ASSERT_TRUE(settings.ok()) << settings.status();
  ASSERT_EQ(settings->size(), 1U);
  EXPECT_EQ(settings->front().labels.size(), 2U * kEach);
}

TEST_F(PostgresAccessTest, VersionsGoOnAboveThoseBeforeARestore) {
  const auto access = Access();
  Revocation revocation;
  revocation.value = "a";
  ASSERT_TRUE(*access->Revoke(revocation, Did()));
  const AccessVersion before = *access->Version();
  // As a backup has it that was made before.
  shell_.Run("DELETE FROM uplinkd.revocations");
  shell_.Run("UPDATE uplinkd.access_version SET version = 0");
  EXPECT_LT(*access->Version(), before) << "by which servers notice";
  EXPECT_TRUE(testing::Eventually([&] {
    return std::stoull(shell_.Read("SELECT (extract(epoch FROM now()) * 1000)::bigint")) >
           before + 1;
  }));
  ASSERT_TRUE(*access->Revoke(revocation, Did()));
  EXPECT_GT(*access->Version(), before) << "none is given a second time";
}

}  // namespace
}  // namespace uplink::storage::postgres
