#include "server/rcan/series_names.h"

#include <set>

#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::rcan {
namespace {

using std::chrono::hours;
using std::chrono::minutes;
using std::chrono::seconds;

constexpr SeriesNames::Set kOne = 1;
constexpr SeriesNames::Set kAll = 0xff;

class SeriesNamesTest : public ::testing::Test {
 protected:
  void Scrape(milliseconds later = seconds(30)) {
    clock_.Advance(later);
    names_.BeginScrape(clock_.Steady());
  }
  bool Shows(std::uint64_t label) { return names_.Admit(label, kOne, limits_).shown == kOne; }
  /// How many of so many labels from `first` on are shown.
  std::size_t Shown(std::uint64_t first, std::size_t count) {
    std::size_t shown = 0;
    for (std::size_t i = 0; i < count; ++i) shown += Shows(first + i) ? 1U : 0U;
    return shown;
  }
  /// All names are taken by the labels 0 to names_max - 1.
  void Fill() {
    Scrape();
    EXPECT_EQ(Shown(0, limits_.names_max), limits_.names_max);
  }

  testing::ManualClock clock_;
  SeriesNames names_;
  SeriesNames::Limits limits_{.names_max = 512, .new_per_hour = 64, .forget_after = minutes(10)};
};

TEST_F(SeriesNamesTest, TheFirstNamesAreFreeAndOneMoreHasNoPlace) {
  Scrape();
  EXPECT_EQ(Shown(0, 512), 512U);
  const SeriesNames::Answer answer = names_.Admit(512, kOne, limits_);
  EXPECT_EQ(answer.shown, 0);
  EXPECT_EQ(answer.no_place, kOne);
  EXPECT_EQ(names_.size(), 512U);
  Scrape();
  EXPECT_EQ(Shown(0, 512), 512U) << "who was there stays";
  EXPECT_FALSE(Shows(512));
}

TEST_F(SeriesNamesTest, TheFirstNamesMayComeOneAfterTheOther) {
  for (std::uint64_t label = 0; label < 512; ++label) {
    Scrape(seconds(1));
    EXPECT_TRUE(Shows(label));
  }
  EXPECT_FALSE(Shows(512));
}

TEST_F(SeriesNamesTest, OfNewNames64HaveTheirPlaceInAnHourAndThe65thHasNot) {
  Fill();
  Scrape(hours(1));
  Scrape();
  EXPECT_EQ(Shown(1000, 64), 64U);
  const SeriesNames::Answer answer = names_.Admit(1064, kOne, limits_);
  EXPECT_EQ(answer.shown, 0);
  EXPECT_EQ(answer.no_place, 0) << "places are there, but too many names are new";
  EXPECT_EQ(names_.size(), 512U);
  Scrape(milliseconds(56'250));
  EXPECT_TRUE(Shows(1064)) << "a 64th of an hour later";
  EXPECT_FALSE(Shows(1065));
  Scrape(hours(1));
  EXPECT_EQ(Shown(2000, 100), 64U);
}

TEST_F(SeriesNamesTest, NobodyLosesAPlaceBeforeTheTime) {
  Fill();
  Scrape();
  EXPECT_EQ(Shown(1, 511), 511U) << "the first one is not said any more";
  Scrape(minutes(10) - seconds(30) - milliseconds(1));
  EXPECT_FALSE(Shows(1000));
  Scrape(milliseconds(1));
  EXPECT_TRUE(Shows(1000)) << "at the time";
  EXPECT_FALSE(Shows(1001)) << "there was one place";
  EXPECT_FALSE(Shows(0)) << "and it is gone";
}

TEST_F(SeriesNamesTest, WhoWasAwayFindsItsPlacesWhateverItSaysFirst) {
  Fill();
  Scrape(hours(8));
  EXPECT_FALSE(Shows(1000)) << "said before those that were said last";
  EXPECT_EQ(Shown(0, 512), 512U);
}

TEST_F(SeriesNamesTest, ANameThatComesAgainIsNewIfItsPlaceWasTaken) {
  limits_ = {.names_max = 2, .new_per_hour = 2, .forget_after = minutes(10)};
  Fill();
  for (int i = 0; i < 2; ++i) {
    Scrape(minutes(10));
    EXPECT_TRUE(Shows(1));
  }
  EXPECT_TRUE(Shows(1000)) << "in the place of 0";
  for (int i = 0; i < 2; ++i) {
    Scrape(minutes(5));
    EXPECT_TRUE(Shows(1));
  }
  EXPECT_TRUE(Shows(0));
  EXPECT_FALSE(Shows(1000));
}

TEST_F(SeriesNamesTest, SeriesOfOneLabelAreNamesEach) {
  limits_.names_max = 10;
  Scrape();
  EXPECT_EQ(names_.Admit(1, 0b11, limits_).shown, 0b11);
  EXPECT_EQ(names_.Admit(1, 0b110, limits_).shown, 0b110);
  EXPECT_EQ(names_.size(), 3U);
  const SeriesNames::Answer answer = names_.Admit(2, kAll, limits_);
  EXPECT_EQ(answer.shown, 0b0111'1111) << "seven places are left";
  EXPECT_EQ(answer.no_place, 0b1000'0000);
  EXPECT_EQ(names_.size(), 10U);
}

TEST_F(SeriesNamesTest, WhoTakesAPlaceOfALabelWithManyLeavesTheOthersFree) {
  limits_ = {.names_max = 8, .new_per_hour = 64, .forget_after = minutes(10)};
  Scrape();
  EXPECT_EQ(names_.Admit(1, kAll, limits_).shown, kAll);
  Scrape(minutes(5));
  Scrape(minutes(5));
  EXPECT_TRUE(Shows(2));
  EXPECT_EQ(names_.size(), 1U);
  EXPECT_EQ(names_.Admit(3, kAll, limits_).shown, 0b0111'1111);
  EXPECT_EQ(names_.size(), 8U);
}

TEST_F(SeriesNamesTest, WhoRenamesAtEveryScrapeAddsABoundedNumber) {
  std::set<std::uint64_t> seen;
  std::uint64_t label = 0;
  const auto run = [&](minutes span) {
    const std::size_t before = seen.size();
    for (seconds passed{0}; passed < span; passed += seconds(30)) {
      Scrape();
      for (int joint = 0; joint < 256; ++joint) {
        if (Shows(++label)) seen.insert(label);
      }
      EXPECT_LE(names_.size(), 512U);
    }
    return seen.size() - before;
  };
  const std::size_t first = run(minutes(60));
  EXPECT_GE(first, 512U);
  EXPECT_LE(first, 512U + 64 + 64) << "the free ones, a full bucket and what ran into it";
  EXPECT_LE(run(minutes(60)), 64U);
  EXPECT_LE(run(minutes(60)), 64U);
}

}  // namespace
}  // namespace uplink::rcan
