// Leases beyond what one answer holds.
#include <chrono>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "storage/postgres/parts.h"
#include "tests/unit/storage/postgres_fixture.h"

namespace uplink::storage::postgres {
namespace {

class PostgresLeasesTest : public PostgresFixture {
 protected:
  void SetUp() override {
    auto leases = MakeLeases(Options(), clock_);
    ASSERT_TRUE(leases.ok()) << leases.status();
    leases_ = *std::move(leases);
  }

  std::unique_ptr<Leases> leases_;
};

TEST_F(PostgresLeasesTest, OfTooManyThoseRenewedLastAreRead) {
  shell_.Run(
      "INSERT INTO uplinkd.processes SELECT gen_random_uuid(), i::text, 'life', 1, false,"
      " now() - make_interval(secs => i) FROM generate_series(1, " +
      std::to_string(kLeasesMax + 5) + ") AS i");
  const auto leases = leases_->Read();
  ASSERT_TRUE(leases.ok()) << leases.status();
  ASSERT_EQ(leases->size(), kLeasesMax);
  EXPECT_EQ(leases->front().card.name, "1");
  EXPECT_EQ(leases->back().card.name, std::to_string(kLeasesMax));
}

TEST_F(PostgresLeasesTest, HowLongALeaseStandsIsToldByTheDatabasesClock) {
  ASSERT_TRUE(leases_->Renew({"self", "life"}).ok());
  shell_.Run(
      "INSERT INTO uplinkd.processes SELECT gen_random_uuid(), name, 'life', 1, false, now() - ago"
      " FROM (VALUES ('old', interval '100 s'), ('ahead', interval '-100 s')) AS v (name, ago)");
  const auto leases = leases_->Read();
  ASSERT_TRUE(leases.ok()) << leases.status();
  ASSERT_EQ(leases->size(), 3U);
  EXPECT_EQ((*leases)[0].card.name, "ahead");
  EXPECT_EQ((*leases)[0].renewed_ago, std::chrono::seconds(0));
  EXPECT_LT((*leases)[1].renewed_ago, std::chrono::seconds(90));
  EXPECT_GE((*leases)[2].renewed_ago, std::chrono::seconds(100));
}

TEST_F(PostgresLeasesTest, ARenewalTellsAProgramThatALaterStepShutsItOut) {
  shell_.Run("INSERT INTO uplinkd.schema_migrations VALUES (99, 1, 'x', 'y')");
  EXPECT_TRUE(leases_->Renew({"self", "life"}).ok()) << "the step only adds";
  shell_.Run("UPDATE uplinkd.schema_migrations SET oldest = 99 WHERE version = 99");
  const absl::Status renewed = leases_->Renew({"self", "life"});
  EXPECT_TRUE(absl::IsUnimplemented(renewed)) << renewed;
  EXPECT_TRUE(renewed.message().find("run a newer uplinkd") != absl::string_view::npos) << renewed;
}

TEST_F(PostgresLeasesTest, AStoreOfAnEarlierBuildShutsTheProgramOutWhenItIsConnectedTo) {
  shell_.Run("ALTER TABLE uplinkd.schema_migrations DROP COLUMN oldest");
  const absl::Status renewed = leases_->Renew({"self", "life"});
  EXPECT_TRUE(absl::IsUnimplemented(renewed)) << renewed;
  EXPECT_TRUE(renewed.message().find("an earlier build") != absl::string_view::npos) << renewed;
}

TEST_F(PostgresLeasesTest, ALongCardIsCut) {
  ASSERT_TRUE(
      leases_->Renew({std::string(kCardTextMax + 1, 'n'), std::string(kCardTextMax, 'l')}).ok());
  const auto leases = leases_->Read();
  ASSERT_TRUE(leases.ok()) << leases.status();
  ASSERT_EQ(leases->size(), 1U);
  EXPECT_EQ(leases->front().card.name, std::string(kCardTextMax, 'n'));
  EXPECT_EQ(leases->front().card.life, std::string(kCardTextMax, 'l'));
}

TEST_F(PostgresLeasesTest, TheFirstRenewalForgetsWhoLeftLongAgoAndHoldsNoRobot) {
  shell_.Run(
      "INSERT INTO uplinkd.processes SELECT gen_random_uuid(), name, 'life', 1, true, now() - age"
      " FROM (VALUES ('old', interval '25 hours'), ('young', interval '23 hours'),"
      " ('holds', interval '25 hours')) AS v (name, age)");
  shell_.Run(
      "INSERT INTO uplinkd.robots (ruri, fleet, epoch, held_since, owner, first_seen, last_seen)"
      " SELECT 'a', 'f', 1, 1, process, now(), now() FROM uplinkd.processes WHERE name = 'holds'");
  ASSERT_TRUE(leases_->Renew({"self", "life"}).ok());
  EXPECT_EQ(shell_.Read("SELECT string_agg(name, ',' ORDER BY name) FROM uplinkd.processes"),
            "holds,self,young\n");
}

}  // namespace
}  // namespace uplink::storage::postgres
