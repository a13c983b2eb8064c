#include "server/store/silent_rows.h"

#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/fake_forget_store.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::store {
namespace {

using storage::kSilentRobotsMax;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::SizeIs;

class SilentRowsTest : public ::testing::Test {
 protected:
  SilentRowsTest() { trust_.Note(true, ClockPair::Of(clock_)); }

  static std::string Ruri(std::size_t number) { return fmt::format("rcan://{:04}", number); }
  void BeSilent(std::size_t robots) {
    for (std::size_t i = 0; i < robots; ++i) removal_.silent[Ruri(i)] = 3;
  }
  void InMemory(std::size_t number) { ASSERT_TRUE(fleet_.FindOrAdmit({Ruri(number), "f"}).ok()); }
  void Rounds(int rounds) {
    for (int i = 0; i < rounds; ++i) EXPECT_TRUE(rows_.Round().ok());
  }

  testing::ManualClock clock_;
  fleet::Fleet fleet_{clock_, 2 * kSilentRobotsMax, {}};
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  testing::FakeRobotRemoval removal_;
  VouchedClock trust_{clock_};
  SilentRows rows_{{.fleet = fleet_,
                    .clock = clock_,
                    .logger = logger_,
                    .removal = removal_,
                    .process = storage::ProcessId{1},
                    .rule = {.forget_after = std::chrono::hours(24),
                             .retain_history = std::chrono::hours(72),
                             .retain_quarantine = std::chrono::hours(48),
                             .retain_connections = std::chrono::hours(48)},
                    .trust = trust_}};
};

TEST_F(SilentRowsTest, GoOnceNothingOfTheRobotIsKept) {
  InMemory(1);
  BeSilent(2);
  clock_.Advance(std::chrono::seconds(1));
  Rounds(2);
  EXPECT_THAT(removal_.removed, ElementsAre(Pair(Ruri(0), 3))) << "not one in memory";
  EXPECT_EQ(removal_.silent_until, clock_.System() - std::chrono::hours(72 + 24));
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("silent_robots_removed robots=1")));
}

TEST_F(SilentRowsTest, AreLookedForEachHour) {
  Rounds(2);
  EXPECT_EQ(removal_.silent_asked, 1);
  BeSilent(1);
  clock_.Advance(kRemoveSilentEvery - std::chrono::seconds(1));
  Rounds(1);
  EXPECT_THAT(removal_.removed, IsEmpty());
  clock_.Advance(std::chrono::seconds(1));
  Rounds(1);
  EXPECT_THAT(removal_.removed, SizeIs(1));
}

TEST_F(SilentRowsTest, OfAFullAnswerTheNextOneFollowsAtOnce) {
  BeSilent(2 * kSilentRobotsMax + 50);
  Rounds(2);
  EXPECT_THAT(removal_.silent, SizeIs(50));
  Rounds(1);
  EXPECT_THAT(removal_.silent, IsEmpty());
  Rounds(1);
  EXPECT_EQ(removal_.silent_asked, 3) << "an answer that is not full is the last one";
}

TEST_F(SilentRowsTest, ThoseInMemoryHideNobodyBehindThem) {
  BeSilent(kSilentRobotsMax + 1);
  for (std::size_t i = 0; i < kSilentRobotsMax; ++i) InMemory(i);
  Rounds(1);
  EXPECT_THAT(removal_.removed, IsEmpty());
  Rounds(1);
  EXPECT_THAT(removal_.removed, ElementsAre(Pair(Ruri(kSilentRobotsMax), 3)));
  Rounds(5);
  EXPECT_EQ(removal_.silent_asked, 2) << "then the look is over";
  clock_.Advance(kRemoveSilentEvery);
  Rounds(2);
  EXPECT_EQ(removal_.silent_asked, 4) << "the next one begins anew";
}

TEST_F(SilentRowsTest, OneThatIsInMemoryEndsNoLook) {
  BeSilent(2 * kSilentRobotsMax + 50);
  InMemory(7);
  Rounds(3);
  EXPECT_THAT(removal_.silent, ElementsAre(Pair(Ruri(7), 3)));
}

TEST_F(SilentRowsTest, AStoreThatFailsIsTriedAgainAfterAPause) {
  BeSilent(2);
  removal_.remove_status = absl::UnavailableError("locked");
  for (int i = 0; i < 50; ++i) EXPECT_FALSE(rows_.Round().ok());
  EXPECT_EQ(removal_.silent_asked, 1);
  removal_.remove_status = absl::OkStatus();
  removal_.status = absl::UnavailableError("away");
  clock_.Advance(kRemoveSilentAgainAfter);
  for (int i = 0; i < 50; ++i) EXPECT_FALSE(rows_.Round().ok());
  EXPECT_EQ(removal_.silent_asked, 2);
  removal_.status = absl::OkStatus();
  clock_.Advance(kRemoveSilentAgainAfter);
  Rounds(1);
  EXPECT_THAT(removal_.removed, SizeIs(2));
}

TEST_F(SilentRowsTest, NoneGoesByAClockThatNobodyVouchesFor) {
  trust_.Note(false, ClockPair::Of(clock_));
  BeSilent(1);
  Rounds(1);
  EXPECT_THAT(removal_.removed, IsEmpty());
  trust_.Note(true, ClockPair::Of(clock_));
  Rounds(1);
  EXPECT_THAT(removal_.removed, SizeIs(1));
}

TEST(RowsRule, RobotsKeepTheirRowsWhileAnythingIsKeptForEver) {
  const std::chrono::hours day{24};
  const SystemTime now = FromUnixMs(1'763'683'200'000);
  EXPECT_EQ((RowsRule{day * 30, day * 90, day * 14, day * 60}.Until(now)), now - day * 91);
  EXPECT_EQ((RowsRule{day * 300, day * 90, day * 14, day}.Until(now)), now - day * 301);
  EXPECT_EQ((RowsRule{day, day, day, day * 90}.Until(now)), now - day * 91);
  EXPECT_EQ((RowsRule{milliseconds(0), day, day, day}.Until(now)), std::nullopt);
  EXPECT_EQ((RowsRule{day, milliseconds(0), day, day}.Until(now)), std::nullopt);
  EXPECT_EQ((RowsRule{day, day, milliseconds(0), day}.Until(now)), std::nullopt);
  EXPECT_EQ((RowsRule{day, day, day, milliseconds(0)}.Until(now)), std::nullopt);
}

}  // namespace
}  // namespace uplink::store
