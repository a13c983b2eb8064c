// The shared sets of all fleets, as the reader of the store puts them together.
#include "server/forward/forwards.h"

#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/forward/frames.h"
#include "tests/unit/server/forward/receiving.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::forward {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Key;
using ::testing::SizeIs;
using ::testing::StartsWith;

constexpr Shares::Limits kLimits = {
    .bytes_max = 100'000, .fleet_bytes_max = 50'000, .robot_bytes_max = 10'000};

const std::string kNorth = "north";

class ForwardsTest : public ::testing::Test {
 protected:
  void Put(const ItemKey& key, const std::string& text, std::int64_t expires_ms = 0,
           const std::string& fleet = "north") {
    forwards_.Put(key, {fleet, expires_ms}, [&](const nexus_command::CommandId& command) {
      return Text(text + std::string(reinterpret_cast<const char*>(command.data()), 16));
    });
  }
  std::unique_ptr<session::ForwardReceiver> Join(const std::string& robot,
                                                 const std::string& fleet = "north") {
    return forwards_.Join({.ruri = robot, .fleet = fleet}, {&woken_, 1});
  }
  /// What comes, without the numbers of commands: deletions as `gone`, marks as `begin` and `end`.
  static std::vector<std::string> Take(session::ForwardReceiver& receiver) {
    std::vector<EncodedFrame> frames;
    for (std::size_t before = 1; before != frames.size();) {
      before = frames.size();
      receiver.Take(frames);
    }
    std::vector<std::string> texts;
    for (const EncodedFrame& frame : frames) {
      v1::RelayResponse response;
      if (*frame == *SnapshotBegin()) {
        texts.emplace_back("begin");
      } else if (*frame == *SnapshotEnd()) {
        texts.emplace_back("end");
      } else if (response.ParseFromString(*frame) && response.has_forward()) {
        texts.push_back("gone of " + response.forward().origin_ruri());
      } else {
        texts.push_back(frame->substr(0, frame->size() - 16));
      }
    }
    return texts;
  }

  Woken woken_;
  Forwards forwards_{kLimits, std::mt19937_64(1)};
};

TEST_F(ForwardsTest, FleetsDoNotHearEachOther) {
  forwards_.SetWhole();
  const auto north = Join("a");
  const auto south = Join("b", "south");
  EXPECT_THAT(Take(*north), ElementsAre("begin", "end"));
  EXPECT_THAT(Take(*south), ElementsAre("begin", "end"));
  Put(KeyOf("c", "1"), "hazard");
  EXPECT_THAT(Take(*north), ElementsAre("hazard"));
  EXPECT_THAT(Take(*south), IsEmpty());
}

TEST_F(ForwardsTest, NothingIsToldUntilAllWasRead) {
  const auto before = Join("a");
  Put(KeyOf("c", "1"), "hazard");
  EXPECT_THAT(Take(*before), IsEmpty());
  forwards_.SetWhole();
  EXPECT_EQ(forwards_.WakeReceivers(), 1U);
  EXPECT_THAT(woken_.Take(), ElementsAre(1));
  EXPECT_THAT(Take(*before), ElementsAre("begin", "hazard", "end"));
  const auto new_fleet = Join("b", "south");
  EXPECT_THAT(Take(*new_fleet), ElementsAre("begin", "end"));
}

TEST_F(ForwardsTest, AReceiverIsWokenOnceForAllThatALookBrings) {
  forwards_.SetWhole();
  const auto a = Join("a");
  static_cast<void>(Take(*a));
  for (const char* id : {"1", "2", "3"}) Put(KeyOf("c", id), "hazard");
  EXPECT_THAT(woken_.Take(), IsEmpty()) << "the look is not over";
  EXPECT_EQ(forwards_.WakeReceivers(), 1U);
  EXPECT_THAT(woken_.Take(), ElementsAre(1));
  forwards_.Remove(KeyOf("c", "1"));
  EXPECT_EQ(forwards_.WakeReceivers(), 0U) << "it has not looked since";
  EXPECT_THAT(Take(*a), ElementsAre("hazard", "hazard"));
  forwards_.Remove(KeyOf("c", "2"));
  EXPECT_EQ(forwards_.WakeReceivers(), 1U);
}

TEST_F(ForwardsTest, WhatIsTheSameIsNotToldAgain) {
  forwards_.SetWhole();
  const auto a = Join("a");
  Put(KeyOf("c", "1"), "hazard");
  static_cast<void>(Take(*a));
  Put(KeyOf("c", "1"), "hazard", 1000);
  EXPECT_THAT(Take(*a), IsEmpty());
  Put(KeyOf("c", "1"), "moved", 1000);
  EXPECT_THAT(Take(*a), ElementsAre("moved"));
}

TEST_F(ForwardsTest, EachChangeIsACommandOfItsOwn) {
  forwards_.SetWhole();
  std::set<nexus_command::CommandId> commands;
  for (const char* text : {"1", "2", "3"}) {
    nexus_command::CommandId last{};
    forwards_.Put(KeyOf("c", "1"), {kNorth}, [&](const nexus_command::CommandId& command) {
      last = command;
      return Text(text);
    });
    commands.insert(last);
  }
  EXPECT_THAT(commands, SizeIs(3));
}

TEST_F(ForwardsTest, AnItemThatMovesToAnotherFleetLeavesTheFirst) {
  forwards_.SetWhole();
  const auto north = Join("a");
  const auto south = Join("b", "south");
  Put(KeyOf("c", "1"), "hazard");
  static_cast<void>(Take(*north));
  static_cast<void>(Take(*south));
  Put(KeyOf("c", "1"), "hazard", 0, "south");
  EXPECT_THAT(Take(*north), ElementsAre("gone of c"));
  EXPECT_THAT(Take(*south), ElementsAre("hazard"));
  EXPECT_EQ(forwards_.sum().items, 1U);
}

TEST_F(ForwardsTest, WhatExpiresGoes) {
  forwards_.SetWhole();
  const auto a = Join("a");
  Put(KeyOf("c", "1"), "hazard", 1000);
  Put(KeyOf("c", "2"), "stays");
  static_cast<void>(Take(*a));
  forwards_.Expire(FromUnixMs(999));
  EXPECT_THAT(Take(*a), IsEmpty());
  forwards_.Expire(FromUnixMs(1000));
  EXPECT_THAT(Take(*a), ElementsAre("gone of c"));
  EXPECT_THAT(forwards_.Keys(), ElementsAre(KeyOf("c", "2")));
}

TEST_F(ForwardsTest, ALaterExpiryCountsThoughNothingElseChanged) {
  forwards_.SetWhole();
  Put(KeyOf("c", "1"), "hazard", 1000);
  Put(KeyOf("c", "1"), "hazard", 2000);
  forwards_.Expire(FromUnixMs(1999));
  EXPECT_EQ(forwards_.sum().items, 1U);
  forwards_.Expire(FromUnixMs(2000));
  EXPECT_EQ(forwards_.sum().items, 0U);
}

TEST_F(ForwardsTest, AnItemThatGrowsTakesMoreOfTheRoom) {
  Put(KeyOf("c", "1"), "small");
  const std::size_t before = forwards_.sum().bytes;
  Put(KeyOf("c", "1"), std::string(1'005, 'x'));
  EXPECT_EQ(forwards_.sum().bytes, before + 1'000);
  forwards_.Remove(KeyOf("c", "1"));
  EXPECT_EQ(forwards_.sum().bytes, 0U);
}

TEST_F(ForwardsTest, OneRobotFillsNoMoreThanItsShare) {
  forwards_.SetWhole();
  const auto a = Join("a");
  const std::string large(4'000, 'x');
  Put(KeyOf("c", "1"), large);
  Put(KeyOf("c", "2"), large);
  Put(KeyOf("c", "3"), large);
  EXPECT_TRUE(forwards_.left_out());
  EXPECT_THAT(forwards_.Keys(), ElementsAre(KeyOf("c", "1"), KeyOf("c", "2")));
  Put(KeyOf("d", "1"), "small");
  EXPECT_THAT(Take(*a), ElementsAre("begin", large, large, "small", "end"));
  // One that outgrows the share is not shown as it was any more.
  Put(KeyOf("c", "2"), std::string(8'000, 'y'));
  EXPECT_THAT(Take(*a), ElementsAre("gone of c"));
  EXPECT_THAT(forwards_.shares().robots_left_out(), ElementsAre(Key("c")));
}

TEST_F(ForwardsTest, WhoSharesMostGivesWayToWhoSharesLittle) {
  forwards_.SetWhole();
  const std::string large(4'000, 'x');
  // Five robots fill the fleet's share with two items each.
  for (const char* robot : {"a", "b", "c", "d", "e"}) {
    for (const char* id : {"1", "2"}) Put(KeyOf(robot, id), large);
  }
  Put(KeyOf("f", "1"), large);
  const auto reader = Join("reader");
  EXPECT_THAT(Take(*reader), SizeIs(1 + 11 + 1));
  Put(KeyOf("f", "2"), large);
  const std::size_t before = forwards_.sum().items;
  const std::string smaller(3'000, 'y');
  Put(KeyOf("honest", "1"), smaller);
  EXPECT_EQ(forwards_.sum().items, before) << "it came, and one of another's went";
  const auto told = Take(*reader);
  EXPECT_THAT(told, ::testing::Contains(smaller));
  EXPECT_THAT(told, ::testing::Contains(StartsWith("gone of ")));
  EXPECT_TRUE(forwards_.left_out());
  for (const auto& [robot, most_from] : forwards_.shares().robots_left_out()) {
    EXPECT_NE(robot, "honest");
    EXPECT_NE(most_from, "");
  }
  // One that has two of them already is not let in by anybody.
  Put(KeyOf("a", "3"), large);
  EXPECT_THAT(forwards_.shares().robots_left_out(), ::testing::Contains(Key("a")));
}

TEST_F(ForwardsTest, AFrameThatCannotHaveRoomIsNotMade) {
  bool made = false;
  forwards_.Put(KeyOf("c", "1"), {.fleet = kNorth, .least_bytes = kLimits.robot_bytes_max},
                [&](const nexus_command::CommandId&) {
                  made = true;
                  return Text("x");
                });
  EXPECT_FALSE(made);
  EXPECT_TRUE(forwards_.left_out());
}

TEST_F(ForwardsTest, WhatIsPutOffLivesAsLongAsItIsToAndInItsFleetAlone) {
  forwards_.SetWhole();
  const auto a = Join("a");
  Put(KeyOf("c", "1"), "hazard", 1000);
  static_cast<void>(Take(*a));
  forwards_.Postpone(KeyOf("c", "1"), "north", 2000);
  forwards_.Postpone(KeyOf("c", "unknown"), "north", 2000);
  forwards_.Expire(FromUnixMs(1999));
  EXPECT_THAT(Take(*a), IsEmpty());
  forwards_.Postpone(KeyOf("c", "1"), "north", 1500);
  forwards_.Expire(FromUnixMs(1999));
  EXPECT_THAT(Take(*a), ElementsAre("gone of c"));
  Put(KeyOf("c", "2"), "hazard");
  static_cast<void>(Take(*a));
  forwards_.Postpone(KeyOf("c", "2"), "south", 0);
  EXPECT_THAT(Take(*a), ElementsAre("gone of c"));
}

TEST_F(ForwardsTest, WhatCannotBeMadeAFrameIsNotThere) {
  forwards_.SetWhole();
  const auto none = [](const nexus_command::CommandId&) -> EncodedFrame { return nullptr; };
  forwards_.Put(KeyOf("c", "1"), {kNorth}, none);
  EXPECT_THAT(forwards_.Keys(), IsEmpty());
  Put(KeyOf("c", "1"), "hazard");
  const auto a = Join("a");
  static_cast<void>(Take(*a));
  forwards_.Put(KeyOf("c", "1"), {kNorth}, none);
  EXPECT_THAT(Take(*a), ElementsAre("gone of c"));
  EXPECT_EQ(forwards_.sum().bytes, 0U);
}

TEST_F(ForwardsTest, AStreamThatEndedIsNotWoken) {
  forwards_.SetWhole();
  auto a = Join("a");
  static_cast<void>(Take(*a));
  a.reset();
  Put(KeyOf("c", "1"), "hazard");
  EXPECT_THAT(woken_.Take(), IsEmpty());
  EXPECT_EQ(forwards_.sum().receivers, 0U);
}

}  // namespace
}  // namespace uplink::forward
