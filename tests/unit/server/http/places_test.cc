#include "server/http/places.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::http {
namespace {

using State = Places::State;
using Room = Places::Room;

struct Holder final : PlaceHolder {
  void GiveWay() override { gave_way = true; }
  bool gave_way = false;
};

class PlacesTest : public ::testing::Test {
 protected:
  static constexpr std::size_t kPlaces = kMonitoringPlaces + 2;

  Room MakeRoom() { return places_.MakeRoom({}, clock_.Steady()); }
  /// Takes all places, a second apart.
  void Fill() {
    for (Holder& holder : holders_) {
      ASSERT_EQ(MakeRoom(), Room::kFree);
      taken_.push_back(places_.Take(holder, {}, clock_.Steady()));
      clock_.Advance(std::chrono::seconds(1));
    }
  }
  void Note(std::size_t place, State state) { Places::Note(taken_[place], state, clock_.Steady()); }

  testing::ManualClock clock_;
  Places places_{kPlaces};
  std::array<Holder, kPlaces> holders_;
  std::vector<Places::Handle> taken_;
};

TEST_F(PlacesTest, TheLastFourAreForMonitoringOnly) {
  Fill();
  for (std::size_t i = 0; i < kPlaces; ++i) {
    EXPECT_EQ(taken_[i]->monitoring_only, i >= kPlaces - kMonitoringPlaces) << i;
  }
}

TEST_F(PlacesTest, APlaceThatIsFreeAgainIsForAnything) {
  Fill();
  places_.Leave(taken_[0]);
  EXPECT_EQ(MakeRoom(), Room::kFree);
  EXPECT_FALSE(places_.Take(holders_[0], {}, clock_.Steady())->monitoring_only);
}

TEST_F(PlacesTest, AFreePlaceForMonitoringStaysOne) {
  Fill();
  places_.Leave(taken_[5]);
  EXPECT_EQ(MakeRoom(), Room::kFree);
  EXPECT_TRUE(places_.Take(holders_[5], {}, clock_.Steady())->monitoring_only);
}

TEST_F(PlacesTest, WhoHasBeenIdleForLongestGivesWay) {
  Fill();
  Note(0, State::kBusy);
  Note(1, State::kIdle);  // again, and later than the others
  EXPECT_EQ(MakeRoom(), Room::kGivenWay);
  for (std::size_t i = 0; i < kPlaces; ++i) EXPECT_EQ(holders_[i].gave_way, i == 2) << i;
  EXPECT_EQ(MakeRoom(), Room::kFree) << "its place is free at once";
}

TEST_F(PlacesTest, WhoTakesAnAnswerSlowlyGivesWayAfterTheIdle) {
  Fill();
  for (std::size_t i = 0; i < kPlaces; ++i) Note(i, State::kBusy);
  Note(3, State::kAnswering);
  clock_.Advance(kSlowAnswer);
  EXPECT_EQ(MakeRoom(), Room::kNone) << "not slow yet";
  clock_.Advance(milliseconds(1));
  Note(4, State::kIdle);
  EXPECT_EQ(MakeRoom(), Room::kGivenWay);
  EXPECT_TRUE(holders_[4].gave_way);
  static_cast<void>(places_.Take(holders_[4], {}, clock_.Steady()));
  Note(3, State::kAnswering);
  clock_.Advance(kNotReadYet + milliseconds(1));
  EXPECT_EQ(MakeRoom(), Room::kGivenWay) << "the new one is idle";
  EXPECT_FALSE(holders_[3].gave_way);
}

TEST_F(PlacesTest, WhoHasJustComeGivesWayAfterAScrape) {
  Fill();
  for (std::size_t i = 0; i < kPlaces; ++i) Note(i, State::kScraping);
  places_.Leave(taken_[5]);
  taken_[5] = places_.Take(holders_[5], {}, clock_.Steady());
  clock_.Advance(kNotReadYet);
  EXPECT_EQ(MakeRoom(), Room::kGivenWay);
  EXPECT_FALSE(holders_[5].gave_way) << "its request may be there, and is not read yet";
  EXPECT_TRUE(holders_[4].gave_way);
  taken_[4] = places_.Take(holders_[4], {}, clock_.Steady());
  clock_.Advance(milliseconds(1));
  EXPECT_EQ(MakeRoom(), Room::kGivenWay);
  EXPECT_TRUE(holders_[5].gave_way) << "it says nothing";
}

TEST_F(PlacesTest, WhereAllHaveJustComeTheFirstOfThemGivesWay) {
  for (Holder& holder : holders_) taken_.push_back(places_.Take(holder, {}, clock_.Steady()));
  EXPECT_EQ(MakeRoom(), Room::kGivenWay);
  EXPECT_TRUE(holders_[0].gave_way);
}

TEST_F(PlacesTest, AScrapeGivesWayLastAndTheNewestFirst) {
  Fill();
  for (std::size_t i = 0; i < kPlaces; ++i) {
    Note(i, State::kScraping);
    clock_.Advance(milliseconds(1));
  }
  Note(2, State::kBusy);
  Note(1, State::kAnswering);
  clock_.Advance(kSlowAnswer + milliseconds(1));
  EXPECT_EQ(MakeRoom(), Room::kGivenWay);
  EXPECT_TRUE(holders_[1].gave_way) << "a slow peer before a scrape";
  static_cast<void>(places_.Take(holders_[1], {}, clock_.Steady()));
  clock_.Advance(kNotReadYet + milliseconds(1));
  EXPECT_EQ(MakeRoom(), Room::kGivenWay) << "the new one is idle";
  taken_[1] = places_.Take(holders_[1], {}, clock_.Steady());
  Note(1, State::kBusy);
  EXPECT_EQ(MakeRoom(), Room::kGivenWay);
  for (const std::size_t i : {0U, 2U, 3U, 4U}) EXPECT_FALSE(holders_[i].gave_way) << i;
  EXPECT_TRUE(holders_[5].gave_way);
}

TEST_F(PlacesTest, WhoIsAnsweredNeverGivesWay) {
  Fill();
  for (std::size_t i = 0; i < kPlaces; ++i) Note(i, State::kBusy);
  clock_.Advance(std::chrono::hours(1));
  EXPECT_EQ(MakeRoom(), Room::kNone);
}

TEST_F(PlacesTest, NoneIsCrowdedWithoutShares) {
  Fill();
  for (const Places::Handle& place : taken_) EXPECT_FALSE(places_.Crowded(place));
}

/// Sixteen places, four for a source.
class SharedPlacesTest : public ::testing::Test {
 protected:
  static constexpr std::size_t kPlaces = 16;
  static constexpr std::size_t kShare = 4;

  static Source SourceAt(std::uint8_t n) { return {n}; }
  Room MakeRoom(std::uint8_t source) { return places_.MakeRoom(SourceAt(source), clock_.Steady()); }
  /// For each of so many connections of a source, a millisecond apart.
  void Take(std::uint8_t source, std::size_t count, State state) {
    for (std::size_t i = 0; i < count; ++i) {
      ASSERT_EQ(MakeRoom(source), Room::kFree);
      taken_.push_back(places_.Take(holders_.emplace_back(), SourceAt(source), clock_.Steady()));
      Places::Note(taken_.back(), state, clock_.Steady());
      clock_.Advance(milliseconds(1));
    }
  }

  testing::ManualClock clock_;
  std::deque<Holder> holders_;
  Places places_{kPlaces, kShare};
  std::vector<Places::Handle> taken_;
};

TEST_F(SharedPlacesTest, ASourceThatIsAnsweredHasItsShareAndNoMore) {
  Take(1, kShare, State::kBusy);
  EXPECT_EQ(MakeRoom(1), Room::kNone);
  EXPECT_EQ(MakeRoom(2), Room::kFree);
  places_.Leave(taken_[2]);
  EXPECT_EQ(MakeRoom(1), Room::kFree);
}

TEST_F(SharedPlacesTest, AProxyHasNoShare) {
  for (std::size_t i = 0; i < kPlaces; ++i) {
    ASSERT_EQ(places_.MakeRoom(SourceAt(1), clock_.Steady(), Places::Of::kProxy), Room::kFree) << i;
    taken_.push_back(
        places_.Take(holders_.emplace_back(), SourceAt(1), clock_.Steady(), Places::Of::kProxy));
  }
  for (const Places::Handle& place : taken_) EXPECT_FALSE(places_.Crowded(place));
}

TEST_F(SharedPlacesTest, ASourceThatHasItsShareGivesWayToItselfAlone) {
  Take(2, 1, State::kIdle);
  Take(1, kShare - 1, State::kBusy);
  Take(1, 1, State::kIdle);
  EXPECT_EQ(MakeRoom(1), Room::kGivenWay);
  EXPECT_TRUE(holders_[kShare].gave_way);
  EXPECT_FALSE(holders_[0].gave_way) << "idle for longer, and of another source";
}

TEST_F(SharedPlacesTest, WhereAllAreTakenAnySourceGivesWay) {
  for (std::uint8_t source = 1; source <= kPlaces / kShare; ++source) {
    Take(source, kShare, source == 3 ? State::kIdle : State::kBusy);
  }
  EXPECT_EQ(MakeRoom(1), Room::kNone) << "it has its share";
  EXPECT_EQ(MakeRoom(9), Room::kGivenWay);
  EXPECT_TRUE(holders_[2 * kShare].gave_way);
}

TEST(WatchPlacesTest, OnceHalfOfThemAreTakenACallerHasFour) {
  testing::ManualClock clock;
  std::deque<Holder> holders;
  Places places(32);
  const auto watch = [&](const std::string& caller) {
    const auto place = places.Take(holders.emplace_back(), {}, clock.Steady());
    return places.Watch(place, caller, clock.Steady());
  };
  for (int i = 0; i < 8; ++i) EXPECT_TRUE(watch("token a")) << i;
  EXPECT_FALSE(watch("token a")) << "half of the half";
  for (std::size_t i = 0; i < kCrowdedWatchesOfCaller; ++i) EXPECT_TRUE(watch("token b")) << i;
  EXPECT_FALSE(watch("token b"));
  EXPECT_TRUE(watch("token admin"));
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(watch("")) << "callers that cannot be told apart";
  EXPECT_FALSE(watch("token c")) << "half of all places are watches";
}

TEST_F(SharedPlacesTest, IsCrowdedOverHalfOfTheSharesPlaces) {
  Take(1, kShare / 2, State::kBusy);
  EXPECT_FALSE(places_.Crowded(taken_[0]));
  Take(1, 1, State::kBusy);
  for (const Places::Handle& place : taken_) EXPECT_TRUE(places_.Crowded(place));
  Take(2, 1, State::kBusy);
  EXPECT_FALSE(places_.Crowded(taken_.back())) << "another source is not";
}

TEST_F(SharedPlacesTest, IsCrowdedOverHalfOfAllPlaces) {
  for (std::uint8_t source = 1; source <= kPlaces / 2; ++source) Take(source, 1, State::kBusy);
  EXPECT_FALSE(places_.Crowded(taken_[0]));
  Take(9, 1, State::kBusy);
  for (const Places::Handle& place : taken_) EXPECT_TRUE(places_.Crowded(place));
}

}  // namespace
}  // namespace uplink::http
