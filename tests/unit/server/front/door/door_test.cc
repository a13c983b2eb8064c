#include "server/front/door/door.h"

#include <algorithm>
#include <vector>

#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/transport/descriptors.h"

namespace uplink::front {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using transport::TurnedAway;

SourceAddress SourceOf(std::uint32_t number) {
  in_addr address{};
  address.s_addr = htonl(0xC0000200U + number);
  return SourceAddress::Of(address);
}

class DoorTest : public ::testing::Test {
 protected:
  /// A connection of this source; its number is that of its arrival, from 1.
  void Arrive(std::uint32_t source) {
    door_.Arrive(
        {Descriptor(::open("/dev/null", O_RDONLY | O_CLOEXEC)),
         {.source = SourceOf(source), .text = "peer", .health_check = health_check_, .own = own_}},
        now_);
  }
  /// Those that were admitted begin their handshakes now.
  void BeginAdmitted() {
    for (const std::uint64_t id : admitted_) door_.HandshakeBegan(id, now_);
  }
  [[nodiscard]] std::int64_t TurnedAwayFor(TurnedAway cause) const {
    return probe_.turned_away_total[static_cast<std::size_t>(cause)].value();
  }

  SteadyTime now_{};
  bool health_check_ = false;
  bool own_ = false;
  transport::RelayProbe probe_;
  DoorBook book_{{.connections_max = 10, .lingers_max = 1}, probe_, nullptr};
  std::vector<std::uint64_t> admitted_;
  std::vector<std::uint64_t> cut_;
  Door door_{
      {.under_way_max = 2, .waiting_max = 3},
      book_,
      probe_,
      {.admit = [this](std::uint64_t id, const IncomingConnection&) { admitted_.push_back(id); },
       .cut = [this](std::uint64_t id) { cut_.push_back(id); }}};
};

TEST_F(DoorTest, AdmitsAsManyAsThereArePlacesAndLetsOthersWait) {
  for (int i = 0; i < 4; ++i) Arrive(1);
  EXPECT_THAT(admitted_, ElementsAre(1, 2));
  EXPECT_EQ(door_.waiting(), 2U);
  EXPECT_TRUE(book_.pressed());
  EXPECT_EQ(probe_.handshakes_under_way.value(), 2);
  EXPECT_EQ(probe_.handshakes_waiting.value(), 2);
}

TEST_F(DoorTest, TheNextComesInWhenAHandshakeEnds) {
  for (int i = 0; i < 3; ++i) Arrive(1);
  door_.HandshakeEnded(1, now_);
  EXPECT_THAT(admitted_, ElementsAre(1, 2, 3));
  EXPECT_FALSE(book_.pressed());
  door_.HandshakeEnded(1, now_);  // told twice
  EXPECT_EQ(probe_.handshakes_under_way.value(), 2);
}

TEST_F(DoorTest, AHandshakeThatBeginsMakesRoomForOneThatWaitsForOurCpu) {
  Door door(
      {.under_way_max = 10, .waiting_max = 10, .unbegun_max = 1}, book_, probe_,
      {.admit = [this](std::uint64_t id, const IncomingConnection&) { admitted_.push_back(id); },
       .cut = [](std::uint64_t) {}});
  const auto arrive = [&] {
    door.Arrive({Descriptor(::open("/dev/null", O_RDONLY | O_CLOEXEC)),
                 {.source = SourceOf(1), .text = "peer"}},
                now_);
  };
  for (int i = 0; i < 3; ++i) arrive();
  EXPECT_THAT(admitted_, ElementsAre(1));
  EXPECT_FALSE(book_.pressed()) << "places are free: no handshake has to hurry";
  door.HandshakeBegan(1, now_);
  EXPECT_THAT(admitted_, ElementsAre(1, 2));
  door.HandshakeEnded(2, now_);  // it was closed before it began
  EXPECT_THAT(admitted_, ElementsAre(1, 2, 3));
}

TEST_F(DoorTest, PastWhatMayWaitTheGreediestSourceIsTurnedAway) {
  for (int i = 0; i < 5; ++i) Arrive(1);
  Arrive(2);
  EXPECT_EQ(TurnedAwayFor(TurnedAway::kCrowded), 1);
  EXPECT_EQ(door_.waiting(), 3U);
  door_.HandshakeEnded(1, now_);
  EXPECT_EQ(admitted_.back(), 6U) << "the other source is next";
}

TEST_F(DoorTest, AHealthCheckThatIsTurnedAwayMakesNoNoise) {
  health_check_ = true;
  for (int i = 0; i < 6; ++i) Arrive(1);
  EXPECT_EQ(door_.waiting(), 3U);
  EXPECT_EQ(TurnedAwayFor(TurnedAway::kCrowded), 0);
}

TEST_F(DoorTest, AHandshakeThatLastsGivesWayToAnotherSource) {
  Arrive(1);
  Arrive(1);
  Arrive(2);
  BeginAdmitted();
  door_.Tick(now_ + milliseconds(999));
  EXPECT_THAT(cut_, IsEmpty()) << "it has only just begun";
  door_.Tick(now_ + milliseconds(1000));
  EXPECT_THAT(cut_, ElementsAre(1));
  EXPECT_THAT(admitted_, ElementsAre(1, 2, 3));
}

TEST_F(DoorTest, AHandshakeThatWaitsForOurOwnCpuGivesWayToNobody) {
  Arrive(1);
  Arrive(1);
  Arrive(2);
  now_ += std::chrono::seconds(60);
  door_.Tick(now_);
  EXPECT_THAT(cut_, IsEmpty());
  BeginAdmitted();
  door_.Tick(now_ + milliseconds(999));
  EXPECT_THAT(cut_, IsEmpty());
  door_.Tick(now_ + milliseconds(1000));
  EXPECT_THAT(cut_, ElementsAre(1));
}

TEST_F(DoorTest, ASourceThatWaitsForItselfCutsNobody) {
  for (int i = 0; i < 5; ++i) Arrive(1);
  BeginAdmitted();
  door_.Tick(now_ + std::chrono::seconds(60));
  EXPECT_THAT(cut_, IsEmpty());
}

TEST_F(DoorTest, SourcesOfRobotsComeFirst) {
  book_.known().Enter(SourceOf(7));
  for (int i = 0; i < 4; ++i) Arrive(1);
  Arrive(7);
  door_.HandshakeEnded(1, now_);
  EXPECT_EQ(admitted_.back(), 5U);
}

TEST_F(DoorTest, TheServersOwnHandshakeWaitsForNobodyAndTakesNobodysPlace) {
  for (std::uint32_t source = 1; source <= 6; ++source) Arrive(source);
  own_ = true;
  Arrive(99);
  EXPECT_THAT(admitted_, ElementsAre(1, 2, 7));
  BeginAdmitted();
  door_.Tick(now_ + std::chrono::seconds(60));
  EXPECT_THAT(cut_, IsEmpty());
  door_.HandshakeEnded(7, now_);
  EXPECT_EQ(probe_.handshakes_under_way.value(), 2);
  door_.HandshakeEnded(1, now_);
  EXPECT_EQ(admitted_.size(), 4U);
}

DoorLimits LimitsFor(std::size_t descriptors, ProxyHeaders headers = ProxyHeaders::kNone) {
  return DoorLimitsFor(
      {.streams_max = 40'000, .descriptors_max = descriptors, .reserved = 256, .headers = headers});
}

TEST(DoorLimits, WhatTheRestOfTheServerNeedsIsLeft) {
  const auto connections = [](std::size_t reserved) {
    return DoorLimitsFor({.streams_max = 40'000, .descriptors_max = 20'000, .reserved = reserved})
        .book.connections_max;
  };
  EXPECT_EQ(connections(256) - connections(1256), 1000U);
  EXPECT_EQ(connections(5000), connections(19'000));  // a quarter at most
}

TEST(DoorLimits, AreFullWithTheDescriptorsThatAreWanted) {
  transport::RelayOptions options;
  options.streams_max = 40'000;
  options.descriptors_reserved = 256;
  const std::size_t wanted = transport::DescriptorsWanted(options);
  const std::size_t full = LimitsFor(2 * wanted).book.connections_max;
  EXPECT_EQ(LimitsFor(wanted).book.connections_max, full);
  EXPECT_EQ(LimitsFor(wanted - 1).book.connections_max, full - 1);
}

TEST(DoorLimits, LeaveAReserveAndNeverShareWithStrangers) {
  for (const std::size_t descriptors : {64U, 256U, 1024U, 20'000U, 1'000'000U}) {
    const DoorLimits limits = LimitsFor(descriptors);
    const std::size_t unproven = limits.handshakes.under_way_max + limits.handshakes.waiting_max;
    EXPECT_LE(limits.book.connections_max + limits.book.lingers_max + unproven +
                  std::min<std::size_t>(256, descriptors / 4),
              descriptors)
        << descriptors;
    EXPECT_GE(limits.book.connections_max, 1U);
    EXPECT_GE(limits.handshakes.under_way_max, 1U);
    EXPECT_GE(limits.handshakes.waiting_max, 1U);
  }
  EXPECT_EQ(LimitsFor(1'000'000).book.connections_max, 41'024U);
}

TEST(DoorLimits, HoldWithHardlyAnyDescriptors) {
  for (const ProxyHeaders headers : {ProxyHeaders::kNone, ProxyHeaders::kExpected}) {
    for (std::size_t descriptors = 0; descriptors < 64; ++descriptors) {
      const DoorLimits limits = LimitsFor(descriptors, headers);
      EXPECT_GE(limits.book.connections_max, 1U);
      EXPECT_GE(limits.handshakes.under_way_max, 1U);
      EXPECT_GE(limits.handshakes.waiting_max, 1U);
      EXPECT_LE(limits.handshakes.waiting_max, 64U);
      EXPECT_EQ(limits.proxy_headers_max > 0, headers == ProxyHeaders::kExpected);
    }
  }
}

TEST(DoorLimits, WhoseHeaderIsAwaitedIsOneOfThoseWithoutACertificate) {
  for (const std::size_t descriptors : {256U, 1024U, 20'000U, 1'000'000U}) {
    const DoorLimits limits = LimitsFor(descriptors, ProxyHeaders::kExpected);
    const std::size_t unproven =
        limits.handshakes.under_way_max + limits.handshakes.waiting_max + limits.proxy_headers_max;
    EXPECT_LE(unproven, descriptors / 4);
    EXPECT_LE(limits.book.connections_max + limits.book.lingers_max + unproven +
                  std::min<std::size_t>(256, descriptors / 4),
              descriptors)
        << descriptors;
  }
  const DoorLimits most = LimitsFor(1'000'000, ProxyHeaders::kExpected);
  EXPECT_EQ(most.proxy_headers_max, 1024U);
  EXPECT_EQ(most.handshakes.under_way_max, 512U);
  EXPECT_EQ(most.handshakes.waiting_max, 4096U);
  EXPECT_EQ(LimitsFor(1'000'000).proxy_headers_max, 0U);
}

}  // namespace
}  // namespace uplink::front
