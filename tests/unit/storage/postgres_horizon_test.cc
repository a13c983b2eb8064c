// How long cleaning is held back: by what, and since when.
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "storage/postgres/horizon.h"
#include "storage/postgres/link/connection.h"
#include "tests/unit/storage/postgres_fixture.h"

namespace uplink::storage::postgres {
namespace {

using std::chrono::seconds;

SteadyTime At(std::int64_t s) { return SteadyTime(seconds(s)); }

TEST(HorizonAgeTest, CountsFromTheFirstLookAfterWhatIsHeld) {
  HorizonAge age;
  EXPECT_EQ(age.Note({10, std::nullopt}, At(0)), seconds(0));
  // Transaction 10 began since, and stays.
  EXPECT_EQ(age.Note({11, 10}, At(10)), seconds(0));
  EXPECT_EQ(age.Note({500, 10}, At(20)), seconds(10));
  EXPECT_EQ(age.Note({900, 10}, At(3'600)), seconds(3'590));
  // The next in line had seen 499, not 500.
  EXPECT_EQ(age.Note({950, 499}, At(3'610)), seconds(3'590));
  EXPECT_EQ(age.Note({960, 500}, At(3'620)), seconds(20));
  EXPECT_EQ(age.Note({970, std::nullopt}, At(3'630)), seconds(0));
}

TEST(HorizonAgeTest, WithoutWritesNothingIsHeldBack) {
  HorizonAge age;
  for (int i = 0; i < 100; ++i) EXPECT_EQ(age.Note({10, 10}, At(i)), seconds(0));
}

TEST(HorizonAgeTest, NumbersWrap) {
  HorizonAge age;
  EXPECT_EQ(age.Note({0xFFFF'FFF0U, 0xFFFF'FFE0U}, At(0)), seconds(0));
  EXPECT_EQ(age.Note({5, 0xFFFF'FFE0U}, At(60)), seconds(60));
  EXPECT_EQ(age.Note({9, 5}, At(70)), seconds(0));
}

TEST(HorizonAgeTest, ForgetsHorizonsBeyondItsBoundAndNeverTheOldest) {
  HorizonAge age;
  const int looks = static_cast<int>(HorizonAge::kSeenMax) * 8;
  for (int i = 0; i < looks; ++i) {
    EXPECT_EQ(age.Note({static_cast<std::uint32_t>(100 + i), 50}, At(i)), seconds(i));
  }
  // Half of them are passed: the age is that of a look nearby.
  const milliseconds half =
      age.Note({static_cast<std::uint32_t>(100 + looks), 100U + looks / 2}, At(looks));
  EXPECT_LE(half, seconds(looks / 2));
  EXPECT_GE(half, seconds(looks / 2 - looks / 64));
}

/// What a server says, asked as the role that serves, of what others hold.
class PostgresHorizonTest : public PostgresFixture {
 protected:
  void SetUp() override {
    shell_.Run("CREATE TABLE public.written (a int)");
    connection_ = Connect();
    Look();
  }
  /// After a write of somebody else, ten seconds after the last.
  milliseconds Look() {
    shell_.Run("INSERT INTO public.written VALUES (1)");
    const absl::StatusOr<Horizon> horizon = ReadHorizon(*connection_);
    EXPECT_TRUE(horizon.ok()) << horizon.status();
    return age_.Note(horizon.value_or(Horizon()), now_ += seconds(10));
  }
  /// Of slots, the server has one list for all its databases; other tests may hold them for a
  /// while.
  bool ComesToNothing() {
    for (int i = 0; i < 1'000; ++i) {
      if (Look() < seconds(60)) return true;
    }
    return false;
  }

  SteadyTime now_ = At(0);
  HorizonAge age_;
  std::unique_ptr<Connection> connection_;
};

TEST_F(PostgresHorizonTest, SeesTheSnapshotOfAnotherRole) {
  PostgresShell other = database_.Shell();
  other.Run("BEGIN ISOLATION LEVEL REPEATABLE READ");
  static_cast<void>(other.Read("SELECT 1"));
  for (int i = 0; i < 10; ++i) Look();
  EXPECT_GE(Look(), seconds(100));
  other.Run("ROLLBACK");
  EXPECT_TRUE(ComesToNothing());
}

TEST_F(PostgresHorizonTest, SeesAnIdleTransactionThatWrote) {
  PostgresShell other = database_.Shell();
  other.Run("BEGIN");
  other.Run("INSERT INTO public.written VALUES (2)");
  for (int i = 0; i < 10; ++i) Look();
  EXPECT_GE(Look(), seconds(100));
  other.Run("COMMIT");
  EXPECT_TRUE(ComesToNothing());
}

}  // namespace
}  // namespace uplink::storage::postgres
