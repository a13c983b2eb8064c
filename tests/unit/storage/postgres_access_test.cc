// What operators of several servers decide at once, in one database.
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "storage/postgres/own_connection.h"
#include "storage/postgres/parts.h"
#include "tests/support/eventually.h"
#include "tests/support/fault_proxy.h"
#include "tests/support/temp_folder.h"
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

/// A store behind a proxy, whose calls may take longer than a test.
class PostgresStuckAccessTest : public PostgresAccessTest {
 protected:
  PostgresStuckAccessTest() {
    const std::string password = folder_.File("password");
    std::ofstream(password) << "uplinkd\n";
    StoreOptions options = Options();
    options.url = "postgresql://uplinkd@127.0.0.1:" + std::to_string(proxy_.port()) + "/" +
                  database_.name() + "?sslmode=disable&gssencmode=disable";
    options.password_file = password;
    options.call_timeout = std::chrono::hours(1);
    access_ = *MakeAccessStore(options, clock_);
    EXPECT_TRUE(access_->Version().ok());
  }

  testing::TempFolder folder_;
  testing::FaultProxy proxy_{static_cast<std::uint16_t>(std::stoi(database_.cluster().port))};
  std::unique_ptr<AccessStore> access_;
};

TEST_F(PostgresStuckAccessTest, ALookGivesUpSoonAndTheNextTakesANewConnection) {
  const int connections = proxy_.connections();
  proxy_.Set(testing::ProxyMode::kBlackHole);
  const auto looked = access_->Version();
  EXPECT_TRUE(absl::IsUnavailable(looked.status())) << looked.status();
  EXPECT_EQ(proxy_.connections(), connections);
  proxy_.Set(testing::ProxyMode::kPass);
  const auto version = access_->Version();
  EXPECT_TRUE(version.ok()) << version.status();
  EXPECT_EQ(proxy_.connections(), connections + 1);
}

TEST_F(PostgresStuckAccessTest, AServerThatIsSlowerThanALookMayTakeAnswersTheNext) {
  const int connections = proxy_.connections();
  const auto locked = Connect();
  ASSERT_TRUE(
      locked->RunScript("BEGIN; LOCK TABLE uplinkd.access_version IN ACCESS EXCLUSIVE MODE", "lock")
          .ok());
  EXPECT_TRUE(absl::IsUnavailable(access_->Version().status()));
  // The server process of the first look waits on without a client.
  const std::string newest =
      " FROM pg_stat_activity WHERE datname = current_database() AND application_name = 'uplinkd'"
      " ORDER BY backend_start DESC LIMIT 1";
  const std::string first = shell_.Read("SELECT pid" + newest);
  absl::StatusOr<AccessVersion> version = absl::UnknownError("not asked");
  std::jthread slow([&] { version = access_->Version(); });
  EXPECT_TRUE(testing::Eventually([&] {
    return shell_.Read("SELECT pid" + newest) != first &&
           shell_.Read(
               "SELECT wait_event_type = 'Lock' AND"
               " clock_timestamp() - query_start > interval '600 ms'" +
               newest) == "t\n";
  }));
  EXPECT_TRUE(locked->RunScript("COMMIT", "unlock").ok());
  slow.join();
  EXPECT_TRUE(version.ok()) << version.status();
  EXPECT_EQ(proxy_.connections(), connections + 1);
}

TEST_F(PostgresStuckAccessTest, AChangeOverAConnectionThatWasLostIsWrittenOnceOverANewOne) {
  Revocation revocation;
  revocation.value = "a";
  const auto audit_rows = [this] { return shell_.Read("SELECT count(*) FROM uplinkd.audit"); };
  // The server ends its sessions, as a restart does.
  shell_.Run(
      "SELECT pg_terminate_backend(pid, 10000) FROM pg_stat_activity"
      " WHERE datname = current_database() AND application_name = 'uplinkd'");
  const auto changed = access_->Revoke(revocation, Did());
  ASSERT_TRUE(changed.ok()) << changed.status();
  EXPECT_TRUE(*changed);
  EXPECT_EQ(audit_rows(), "1\n");
  shell_.Run(
      "SELECT pg_terminate_backend(pid, 10000) FROM pg_stat_activity"
      " WHERE datname = current_database() AND application_name = 'uplinkd'");
  const auto rows = access_->RevocationsAfter(0);
  EXPECT_TRUE(rows.ok()) << rows.status();
}

TEST_F(PostgresAccessTest, AServerThatIsLostInTheMiddleOfAChangeDelaysOthersLittle) {
  StoreOptions options = Options();
  options.call_timeout = std::chrono::hours(1);
  const auto lost = *OwnConnection::Make(options, clock_);
  const auto other = *MakeAccessStore(options, clock_);
  const auto written = lost->ReadAndWrite(
      PipelineOf(StoreCallOf("SELECT version FROM uplinkd.access_version WHERE id = 0 FOR UPDATE")),
      [&](const std::vector<Result>& /*read*/) {
        // It waits for the lock, which no timeout but that between the two trips takes away.
        Revocation revocation;
        revocation.value = "a";
        EXPECT_TRUE(other->Revoke(revocation, Did()).value_or(false));
        return std::vector<StoreCall>();
      },
      "hold the lock", kAccessLookMax);
  EXPECT_TRUE(absl::IsUnavailable(written.status())) << written.status();
}

TEST(FollowingAccess, WaitsForNothingAsLongAsAWriterDoes) {
  StoreOptions options;
  const StoreOptions following = FollowingAccess(options);
  EXPECT_LT(following.call_timeout, options.call_timeout);
  EXPECT_LT(following.connect_timeout, options.connect_timeout);
  options.call_timeout = options.connect_timeout = milliseconds(100);
  EXPECT_EQ(FollowingAccess(options).call_timeout, milliseconds(100));
  EXPECT_EQ(FollowingAccess(options).connect_timeout, milliseconds(100));
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
