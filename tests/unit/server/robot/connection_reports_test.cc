#include "server/robot/connection_reports.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/kept_connections.h"
#include "tests/support/manual_clock.h"

namespace uplink::robot {
namespace {

using model::ConnectionEnd;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class ConnectionReportsTest : public ::testing::Test {
 protected:
  storage::ConnectionItem Item() {
    storage::ConnectionItem item;
    item.robot = robot_.id();
    item.began_at = clock_.System();
    item.address = "192.0.2.1:4711";
    return item;
  }
  storage::ConnectionId Begin() { return reports_.Begin(robot_, Item()); }
  void End(const storage::ConnectionId& id, ConnectionEnd why, std::string detail = "cut") {
    storage::ConnectionItem item = Item();
    item.id = id;
    item.messages = 7;
    item.began_at -= std::chrono::seconds(90);
    item.ended = storage::ConnectionEnded{
        .at = clock_.System(), .why = why, .code = "ABORTED", .detail = std::move(detail)};
    reports_.End(robot_, std::move(item));
  }

  testing::ManualClock clock_;
  std::vector<std::string> lines_;
  const log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_,
                            log::Format::kText, log::Level::kInfo};
  testing::KeptConnections kept_{clock_};
  ConnectionReports reports_{
      {.clock = clock_, .logger = logger_, .sink = &kept_, .process = {9}, .seed = 5}};
  const PresenceChanged untold_;
  Robot robot_{
      std::make_shared<const model::RobotId>(model::RobotId{.ruri = "rcan://a/1", .fleet = "f"}),
      clock_.Steady(), clock_, untold_};
};

TEST_F(ConnectionReportsTest, BothEndsAreALineAndAreKept) {
  reports_.SetServer("host:7443");
  End(Begin(), ConnectionEnd::kReplaced, "superseded");
  ASSERT_THAT(lines_, SizeIs(2));
  EXPECT_THAT(lines_.front(), HasSubstr("info robot_connected robot=rcan://a/1 source=uplink "
                                        "peer=192.0.2.1:4711"));
  EXPECT_THAT(lines_.back(), HasSubstr("info robot_disconnected robot=rcan://a/1"));
  EXPECT_THAT(lines_.back(),
              HasSubstr("why=replaced code=ABORTED detail=superseded seconds=90 messages=7"));
  ASSERT_THAT(kept_.begun(), SizeIs(1));
  ASSERT_THAT(kept_.ended(), SizeIs(1));
  EXPECT_EQ(kept_.begun()[0].id, kept_.ended()[0].id);
  EXPECT_EQ(kept_.ended()[0].server, "host:7443");
  EXPECT_EQ(kept_.ended()[0].process, storage::ProcessId{9});
}

TEST_F(ConnectionReportsTest, EachHasAnIdOfItsOwn) {
  const storage::ConnectionId first = Begin();
  EXPECT_NE(first, Begin());
}

TEST_F(ConnectionReportsTest, TheStateKnowsTheLastEndWhileNoneIsOpen) {
  EXPECT_EQ(robot_.state.last_end(), std::nullopt);
  const storage::ConnectionId first = Begin();
  const storage::ConnectionId second = Begin();
  End(first, ConnectionEnd::kReplaced);
  EXPECT_EQ(robot_.state.last_end(), std::nullopt) << "the second one is open";
  End(second, ConnectionEnd::kSilent);
  EXPECT_EQ(robot_.state.last_end(), ConnectionEnd::kSilent);
  EXPECT_EQ(robot_.state.Snapshot(RobotState::Parts::kNone).last_end, ConnectionEnd::kSilent);
  static_cast<void>(Begin());
  EXPECT_EQ(robot_.state.last_end(), std::nullopt);
}

TEST_F(ConnectionReportsTest, ARobotHasSoManyLinesAMinute) {
  const std::size_t pairs = kConnectionLinesMax / 2;
  for (std::size_t i = 0; i < pairs; ++i) End(Begin(), ConnectionEnd::kBroken);
  EXPECT_THAT(lines_, SizeIs(kConnectionLinesMax));
  for (int i = 0; i < 3; ++i) End(Begin(), ConnectionEnd::kBroken);
  EXPECT_THAT(lines_, SizeIs(kConnectionLinesMax));
  EXPECT_THAT(kept_.ended(), SizeIs(pairs + 3)) << "all of them are kept";
  clock_.Advance(kConnectionLinesSpan);
  static_cast<void>(Begin());
  ASSERT_THAT(lines_, SizeIs(kConnectionLinesMax + 1));
  EXPECT_THAT(lines_.back(), HasSubstr("suppressed=6"));
}

TEST_F(ConnectionReportsTest, ADetailIsCutAndShowsNoControlCharacters) {
  End(Begin(), ConnectionEnd::kProtocolError,
      "a\nb" + std::string(2 * storage::kConnectionDetailMax, 'x'));
  const std::string detail = kept_.ended().at(0).ended->detail;
  EXPECT_LE(detail.size(), storage::kConnectionDetailMax);
  EXPECT_EQ(detail.find('\n'), std::string::npos);
}

TEST(RobotStatePresence, ARobotThatIsAdoptedLostItsServerUnlessThatStoppedInOrder) {
  testing::ManualClock clock;
  for (const auto& [written, why] :
       {std::pair(Presence::kOnline, std::optional(ConnectionEnd::kServerEnded)),
        std::pair(Presence::kUnknown, std::optional<ConnectionEnd>())}) {
    RobotState state(clock.Steady(), clock.Steady(), clock.System());
    state.BeginConnection();
    state.EndConnection(ConnectionEnd::kReplaced);
    state.BeginHold({.how = HoldBegan::kAdopted,
                     .since = 2,
                     .presence = storage::StoredPresence{written, clock.System()}},
                    clock.Steady(), clock.System());
    EXPECT_EQ(state.last_end(), why) << "not the one that ended here before";
  }
}

TEST(RobotStatePresence, ARobotThatGoesOfflineSaysWhyItsLastConnectionEnded) {
  using Told = std::pair<Presence, std::optional<model::ConnectionEnd>>;
  std::vector<Told> told;
  testing::ManualClock clock;
  const PresenceLimits limits{};
  RobotState state(
      clock.Steady(), clock.Steady(), clock.System(),
      [&](const storage::StoredPresence& now, auto why) { told.emplace_back(now.presence, why); });
  const auto hear = [&] { state.SignOfLife(clock.Steady(), clock.System(), limits); };
  const auto fall_silent = [&] {
    clock.Advance(limits.timeout + milliseconds(1));
    static_cast<void>(state.Sweep(clock.Steady(), clock.System(), limits));
  };
  state.BeginConnection();
  hear();
  state.EndConnection(model::ConnectionEnd::kBroken);
  fall_silent();
  state.BeginConnection();
  hear();
  fall_silent();
  EXPECT_THAT(told, ::testing::ElementsAre(Told(Presence::kOnline, std::nullopt),
                                           Told(Presence::kOffline, model::ConnectionEnd::kBroken),
                                           Told(Presence::kOnline, std::nullopt),
                                           Told(Presence::kOffline, std::nullopt)))
      << "the last has its connection yet";
}

}  // namespace
}  // namespace uplink::robot
