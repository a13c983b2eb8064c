#include <deque>
#include <optional>

#include <gtest/gtest.h>

#include "server/front/door/place.h"

namespace uplink::front {
namespace {

constexpr SteadyTime kNow{std::chrono::hours(1)};

class PlaceLingerTest : public ::testing::Test {
 protected:
  static TlsPeer Peer(std::uint8_t key) {
    return {.identity = identity::PeerIdentity{}, .ruri = {}, .key = {key}, .expiry = SystemTime{}};
  }
  /// A connection with this certificate, which has to have a place.
  std::optional<std::uint64_t> Come(Place& place, std::uint8_t key) {
    EXPECT_TRUE(place.Take());
    return place.Count(Peer(key), {}, kNow);
  }

  transport::RelayProbe probe_;
  DoorBook book_{{.connections_max = 6, .lingers_max = 2}, probe_, nullptr};
};

TEST_F(PlaceLingerTest, WhoHasAPlaceLingersInIt) {
  Place one(book_, 1);
  ASSERT_EQ(Come(one, 1), std::nullopt);
  EXPECT_TRUE(one.Linger(Peer(1).key));
  EXPECT_EQ(probe_.connections.value(), 1);
  EXPECT_TRUE(book_.keys().Has(1));
  // It takes none of the others.
  EXPECT_TRUE(book_.lingers().Begin(std::nullopt));
  EXPECT_TRUE(book_.lingers().Begin(std::nullopt));
  one.Leave();
  EXPECT_EQ(probe_.connections.value(), 0);
  EXPECT_FALSE(book_.lingers().Begin(std::nullopt));
}

TEST_F(PlaceLingerTest, WhoLingersInItsPlaceGivesWayFirst) {
  Place one(book_, 1);
  Place two(book_, 2);
  Place three(book_, 3);
  Place four(book_, 4);
  Place five(book_, 5);
  for (Place* place : {&one, &two, &three, &four}) {
    ASSERT_EQ(Come(*place, 1), std::nullopt);
    place->SetStreams(1);
  }
  ASSERT_TRUE(three.Linger(Peer(1).key));
  EXPECT_EQ(Come(five, 1), 3U);
}

TEST_F(PlaceLingerTest, WhoIsEvictedLingersWithoutItsPlaceAndSoDoesWhoHadNone) {
  Place first(book_, 1);
  Place second(book_, 2);
  Place third(book_, 3);
  for (Place* place : {&first, &second, &third}) ASSERT_EQ(Come(*place, 1), std::nullopt);
  ASSERT_EQ(book_.keys().Add(Peer(1).key, 9, 3, kNow), 1U);
  ASSERT_EQ(book_.keys().Add(Peer(1).key, 10, 3, kNow), 2U);
  EXPECT_TRUE(first.Linger(Peer(1).key));
  EXPECT_EQ(probe_.connections.value(), 2) << "its place is free at once";
  EXPECT_TRUE(second.Linger(Peer(1).key));
  EXPECT_EQ(probe_.connections.value(), 1);

  ASSERT_EQ(book_.keys().Add(Peer(1).key, 11, 3, kNow), 3U);
  EXPECT_FALSE(third.Linger(Peer(1).key)) << "two may";
  EXPECT_EQ(probe_.connections.value(), 0);
  Place stranger(book_, 12);
  EXPECT_FALSE(stranger.Linger(std::nullopt));
  first.Leave();
  EXPECT_TRUE(stranger.Linger(std::nullopt));
}

TEST_F(PlaceLingerTest, WhoFoundNoPlaceIsBoundedByItsKey) {
  DoorBook book({.connections_max = 0, .lingers_max = 100}, probe_, nullptr);
  std::deque<Place> places;
  std::size_t linger = 0;
  for (std::uint64_t id = 1; id <= 10; ++id) {
    places.emplace_back(book, id);
    EXPECT_FALSE(places.back().Take());
    if (places.back().Linger(Peer(1).key)) ++linger;
  }
  EXPECT_EQ(linger, Lingers::kLingersPerKeyMax);
  places.clear();
  Place again(book, 11);
  EXPECT_FALSE(again.Take());
  EXPECT_TRUE(again.Linger(Peer(1).key));
}

}  // namespace
}  // namespace uplink::front
