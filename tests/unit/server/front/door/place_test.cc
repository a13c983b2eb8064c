#include "server/front/door/place.h"

#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

namespace uplink::front {
namespace {

constexpr SteadyTime kStart{std::chrono::hours(1)};

TlsPeer PeerOf(identity::Role role) {
  return {.identity = identity::PeerIdentity{.role = role, .fleet = "f"},
          .ruri = {},
          .key = {1},
          .expiry = SystemTime{}};
}

class PlaceTest : public ::testing::Test {
 protected:
  /// One more connection of the certificate; says which has to go.
  std::optional<std::uint64_t> Come(identity::Role role) {
    const std::uint64_t number = places_.size() + 1;
    places_.push_back(std::make_unique<Place>(book_, number));
    EXPECT_TRUE(places_.back()->Take());
    const auto evicted = places_.back()->Count(PeerOf(role), {}, kStart);
    places_.back()->SetStreams(1);
    return evicted;
  }
  void Fill(identity::Role role, std::size_t connections) {
    for (std::size_t i = 0; i < connections; ++i) EXPECT_EQ(Come(role), std::nullopt);
  }

  transport::RelayProbe probe_;
  DoorBook book_{{.connections_max = 100, .lingers_max = 1}, probe_, nullptr};
  std::vector<std::unique_ptr<Place>> places_;
};

TEST_F(PlaceTest, ARobotsKeyHasFourConnections) {
  Fill(identity::Role::kRobot, kRobotConnectionsMax);
  EXPECT_EQ(Come(identity::Role::kRobot), 1U);
}

TEST_F(PlaceTest, AGatewaysKeyHasSixteen) {
  Fill(identity::Role::kGateway, kGatewayConnectionsMax);
  EXPECT_EQ(Come(identity::Role::kGateway), 1U);
}

TEST_F(PlaceTest, WhereAllHaveStreamsTheOneHeardLeastRecentlyGoes) {
  Fill(identity::Role::kRobot, kRobotConnectionsMax);
  for (const std::size_t heard : {0U, 2U, 3U}) {
    places_[heard]->NoteHeard(kStart + std::chrono::seconds(6));
  }
  EXPECT_EQ(Come(identity::Role::kRobot), 2U);
}

TEST_F(PlaceTest, OneThatHasShownATokenGivesWayToNoStrangerOfItsSource) {
  Fill(identity::Role::kGateway, kGatewayConnectionsMax);
  EXPECT_EQ(places_[0]->CountAs(KeyOfCaller("a"), {}, kStart), std::nullopt);
  EXPECT_EQ(Come(identity::Role::kGateway), std::nullopt) << "in the place that it left";
  EXPECT_EQ(Come(identity::Role::kGateway), 2U);
}

TEST_F(PlaceTest, ATokenHasSixteen) {
  for (std::size_t i = 0; i <= kGatewayConnectionsMax; ++i) {
    EXPECT_EQ(Come(identity::Role::kGateway), std::nullopt);
    const auto evicted = places_.back()->CountAs(KeyOfCaller("a"), {}, kStart);
    EXPECT_EQ(evicted.value_or(0), i == kGatewayConnectionsMax ? 1U : 0U) << i;
  }
  EXPECT_NE(KeyOfCaller("a"), KeyOfCaller("b"));
}

TEST_F(PlaceTest, ThereAreSoManyInAll) {
  std::vector<std::unique_ptr<Place>> all;
  for (std::uint64_t i = 0; i < 100; ++i) {
    all.push_back(std::make_unique<Place>(book_, i));
    EXPECT_TRUE(all.back()->Take());
  }
  EXPECT_EQ(probe_.connections.value(), 100);
  Place more(book_, 100);
  EXPECT_FALSE(more.Take());
  all.pop_back();
  EXPECT_TRUE(more.Take());
  EXPECT_EQ(probe_.connections.value(), 100);
}

}  // namespace
}  // namespace uplink::front
