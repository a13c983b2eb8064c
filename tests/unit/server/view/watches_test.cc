#include "server/view/watches.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/log/rate_limited.h"
#include "server/robot/live_bytes.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"
#include "tests/support/records.h"
#include "tests/support/server_world.h"

namespace uplink::view {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const std::string kRover = "rcan://example.org/acme/rover/1.0/rover-1";
const std::string kArm = "rcan://example.org/acme/arm/2.0/arm-1";

/// What a reader of a watch has seen: the last of each robot, and changes in order.
struct Reader {
  std::unique_ptr<Watch> watch;
  /// Calls of `ready`.
  std::shared_ptr<int> woken = std::make_shared<int>(0);
  absl::Status over = absl::OkStatus();

  /// Until there is nothing to take: `+ruri`, `-ruri`, `end N`.
  std::vector<std::string> TakeAll() {
    std::vector<std::string> seen;
    while (true) {
      const auto changes = watch->Take();
      if (!changes.ok()) {
        over = changes.status();
        return seen;
      }
      if (changes->empty()) return seen;
      for (const WatchChange& change : *changes) seen.push_back(ToText(change));
    }
  }
  std::string ToText(const WatchChange& change) {
    if (const auto* robot = std::get_if<RobotShown>(&change)) {
      shown[(*robot)->view().id.ruri] = *robot;
      return "+" + (*robot)->view().id.ruri;
    }
    if (const auto* removed = std::get_if<RobotRemoved>(&change)) return "-" + removed->ruri;
    return fmt::format("end {}", std::get<SnapshotShown>(change).robots);
  }
  std::map<std::string, RobotShown> shown{};
};

class WatchesTest : public ::testing::Test {
 protected:
  robot::Robot& Admit(const std::string& ruri, const std::string& fleet = "f") {
    return **fleet_.FindOrAdmit({ruri, fleet});
  }
  void SetBattery(robot::Robot& robot, float percent) {
    std::vector<model::Record> records;
    model::StatusTelemetry status;
    status.battery = model::BatteryStatus{.soc_pct = percent};
    records.push_back(test::RecordOf(std::move(status)));
    robot.state.Apply(records, clock_.Steady());
  }
  Reader Begin(WatchQuery query = {}) {
    Reader reader;
    auto watch = watches_.Begin(std::move(query), [woken = reader.woken] { ++*woken; });
    EXPECT_TRUE(watch.ok()) << watch.status();
    if (watch.ok()) reader.watch = *std::move(watch);
    return reader;
  }

  testing::ManualClock clock_;
  fleet::Fleet fleet_{clock_, 100'000, {}};
  testing::ServerWorld world_;
  Queries queries_{{.clock = clock_,
                    .fleet = fleet_,
                    .reader = world_.reader,
                    .journals = world_.shards,
                    .ledgers = world_.ledgers,
                    .streams = world_.sessions.streams,
                    .version = "9.9.9"}};
  WatchProbe probe_;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  Watches watches_{
      {.clock = clock_, .fleet = fleet_, .queries = queries_, .probe = probe_, .logger = logger_}};
};

TEST_F(WatchesTest, ShowASnapshotThenWhatChanges) {
  robot::Robot& rover = Admit(kRover);
  Admit(kArm);
  Reader reader = Begin();
  EXPECT_THAT(reader.TakeAll(), ElementsAre("+" + kArm, "+" + kRover, "end 2"));

  watches_.Sweep();
  EXPECT_THAT(reader.TakeAll(), IsEmpty());
  EXPECT_EQ(*reader.woken, 0);

  SetBattery(rover, 40);
  watches_.Sweep();
  EXPECT_EQ(*reader.woken, 1);
  EXPECT_THAT(reader.TakeAll(), ElementsAre("+" + kRover));
  EXPECT_EQ(reader.shown[kRover]->view().glance.vitals.battery_percent, 40);
}

TEST_F(WatchesTest, SayWhoseEndedWhyAndAfterWhat) {
  Admit(kRover);
  Reader reader = Begin({.caller = "token 1f2e3d4c"});
  reader.TakeAll();
  clock_.Advance(std::chrono::seconds(7));
  reader.watch.reset();
  ASSERT_THAT(lines_, SizeIs(1));
  EXPECT_THAT(lines_[0], HasSubstr("info watch_ended who=\"token 1f2e3d4c\" why=left seconds=7 "
                                   "changes=2"));
  Reader denied = Begin();
  denied.watch->NoteEnd(WatchEnd::kDenied);
  denied.watch.reset();
  EXPECT_THAT(lines_.back(), HasSubstr("why=denied"));
  Reader last = Begin();
  watches_.Stop();
  last.watch.reset();
  EXPECT_THAT(lines_.back(), HasSubstr("why=stop"));
}

TEST_F(WatchesTest, SayOfManyEndsAFew) {
  for (std::uint32_t i = 0; i < 2 * log::RateLimited::kLinesMax; ++i) Begin().watch.reset();
  EXPECT_THAT(lines_, SizeIs(log::RateLimited::kLinesMax));
}

TEST_F(WatchesTest, ShowARobotThatCameAndTellWhichLeft) {
  Admit(kRover);
  Reader reader = Begin();
  EXPECT_THAT(reader.TakeAll(), ElementsAre("+" + kRover, "end 1"));
  Admit(kArm);
  watches_.Sweep();
  EXPECT_THAT(reader.TakeAll(), ElementsAre("+" + kArm));
  robot::Robot& rover = *fleet_.Find(kRover);
  ASSERT_TRUE(fleet_.BeginLeaving(rover, robot::Robot::LeaveWhen::kAtOnce));
  rover.OnLeft();
  EXPECT_EQ(fleet_.RemoveLeft().size(), 1U);
  watches_.Sweep();
  EXPECT_THAT(reader.TakeAll(), ElementsAre("-" + kRover));
}

TEST_F(WatchesTest, ShowWhatMatchesTheFilterAlone) {
  robot::Robot& rover = Admit(kRover);
  SetBattery(rover, 80);
  SetBattery(Admit(kArm), 10);
  Reader reader = Begin({.filter = {.values = {.battery_below = 50}}});
  EXPECT_THAT(reader.TakeAll(), ElementsAre("+" + kArm, "end 1"));
  SetBattery(rover, 20);
  SetBattery(*fleet_.Find(kArm), 90);
  watches_.Sweep();
  EXPECT_THAT(reader.TakeAll(), ElementsAre("-" + kArm, "+" + kRover));
}

TEST_F(WatchesTest, ShowTheRobotsThatAreNamedAlone) {
  SetBattery(Admit(kRover), 80);
  SetBattery(Admit(kArm), 10);
  Reader reader = Begin({.filter = {.ruris = {kRover, "rcan://never/seen"}}});
  EXPECT_THAT(reader.TakeAll(), ElementsAre("+" + kRover, "end 1"));
  SetBattery(*fleet_.Find(kArm), 20);
  watches_.Sweep();
  EXPECT_THAT(reader.TakeAll(), IsEmpty());
}

TEST_F(WatchesTest, TellThatARobotHasLeftTheScope) {
  robot::Robot& rover = Admit(kRover, "north");
  Admit(kArm, "south");
  Reader reader = Begin({.filter = {.fleets = {"north"}}});
  EXPECT_THAT(reader.TakeAll(), ElementsAre("+" + kRover, "end 1"));
  rover.SetFleet("south");
  watches_.Sweep();
  EXPECT_THAT(reader.TakeAll(), ElementsAre("-" + kRover));
  SetBattery(rover, 20);
  watches_.Sweep();
  EXPECT_THAT(reader.TakeAll(), IsEmpty());
}

TEST_F(WatchesTest, NeverShowARobotThatLeftTheScopeBeforeItWasTaken) {
  robot::Robot& rover = Admit(kRover, "north");
  Reader reader = Begin({.filter = {.fleets = {"north"}}});
  rover.SetFleet("south");
  const std::vector<std::string> seen = reader.TakeAll();
  EXPECT_TRUE(std::ranges::none_of(seen, [](const auto& text) { return text[0] == '+'; }));
  EXPECT_THAT(reader.shown, IsEmpty());
}

TEST_F(WatchesTest, ShowASlowReaderTheLastStateOnce) {
  robot::Robot& rover = Admit(kRover);
  Reader reader = Begin();
  EXPECT_THAT(reader.TakeAll(), ElementsAre("+" + kRover, "end 1"));
  for (int percent = 1; percent <= 50; ++percent) {
    SetBattery(rover, static_cast<float>(percent));
    watches_.Sweep();
  }
  EXPECT_EQ(*reader.woken, 1);
  EXPECT_THAT(reader.TakeAll(), ElementsAre("+" + kRover));
  EXPECT_EQ(reader.shown[kRover]->view().glance.vitals.battery_percent, 50);
}

TEST_F(WatchesTest, EndWhatTakesNothing) {
  robot::Robot& rover = Admit(kRover);
  Reader slow = Begin();
  Reader idle = Begin();
  EXPECT_THAT(idle.TakeAll(), ElementsAre("+" + kRover, "end 1"));
  clock_.Advance(kWatchTakeWait);
  watches_.Sweep();
  EXPECT_EQ(watches_.size(), 2U);
  clock_.Advance(milliseconds(1));
  watches_.Sweep();
  EXPECT_EQ(watches_.size(), 1U);
  EXPECT_EQ(*slow.woken, 1);
  EXPECT_THAT(slow.TakeAll(), IsEmpty());
  EXPECT_EQ(slow.over.code(), absl::StatusCode::kDeadlineExceeded);
  EXPECT_EQ(probe_.slow.value(), 1);
  // A reader for whom there was nothing to take has its time from the first change on.
  SetBattery(rover, 10);
  watches_.Sweep();
  EXPECT_THAT(idle.TakeAll(), ElementsAre("+" + kRover));
}

TEST_F(WatchesTest, SplitManyRobotsIntoSeveralTakes) {
  for (std::size_t i = 0; i < 2 * kWatchTakeMax + 1; ++i) {
    Admit(fmt::format("rcan://example.org/acme/rover/1.0/r-{:04}", i));
  }
  Reader reader = Begin();
  const auto first = reader.watch->Take();
  ASSERT_TRUE(first.ok());
  EXPECT_EQ(first->size(), kWatchTakeMax);
  const std::vector<std::string> rest = reader.TakeAll();
  EXPECT_EQ(rest.size(), kWatchTakeMax + 2);
  EXPECT_EQ(rest.back(), fmt::format("end {}", 2 * kWatchTakeMax + 1));
}

TEST_F(WatchesTest, ShareARobotThatSeveralShow) {
  Admit(kRover);
  Reader one = Begin();
  Reader two = Begin();
  Reader other = Begin({.parts = PartSet::All()});
  for (Reader* reader : {&one, &two, &other}) static_cast<void>(reader->TakeAll());
  EXPECT_EQ(one.shown[kRover], two.shown[kRover]);
  EXPECT_NE(one.shown[kRover], other.shown[kRover]);
  ASSERT_TRUE(one.shown[kRover]->json().ok());
  EXPECT_THAT(*one.shown[kRover]->json(), ::testing::HasSubstr(kRover));
}

TEST_F(WatchesTest, AreBoundedPerCallerAndInAll) {
  std::vector<Reader> readers;
  for (std::size_t i = 0; i < kWatchesPerCallerMax; ++i) {
    readers.push_back(Begin({.caller = "token a"}));
  }
  const auto refused = watches_.Begin({.caller = "token a"}, [] {});
  EXPECT_EQ(refused.status().code(), absl::StatusCode::kResourceExhausted);
  readers.pop_back();
  readers.push_back(Begin({.caller = "token a"}));
  while (readers.size() < kWatchesMax) readers.push_back(Begin());
  EXPECT_EQ(watches_.Begin({.caller = "token b"}, [] {}).status().code(),
            absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(probe_.open.value(), static_cast<std::int64_t>(kWatchesMax));
  EXPECT_EQ(probe_.refused.value(), 2);
  readers.clear();
  EXPECT_EQ(probe_.open.value(), 0);
}

TEST_F(WatchesTest, EndWhenTheServerStops) {
  Reader reader = Begin();
  watches_.Stop();
  EXPECT_EQ(*reader.woken, 1);
  EXPECT_THAT(reader.TakeAll(), IsEmpty());
  EXPECT_EQ(reader.over.code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(watches_.Begin({}, [] {}).status().code(), absl::StatusCode::kUnavailable);
}

TEST_F(WatchesTest, ShowRobotsOfOtherServersAsThoseWriteThem) {
  robot::Robot& rover = Admit(kRover);
  const auto write = [&](std::int64_t at) {
    rover.state.FollowHolder({.held_by = "b:2", .written_at = FromUnixMs(at)},
                             {model::Presence::kOnline, {}});
  };
  write(1'000);
  Reader reader = Begin();
  EXPECT_THAT(reader.TakeAll(), ElementsAre("+" + kRover, "end 1"));
  EXPECT_EQ(reader.shown[kRover]->view().state.foreign->held_by, "b:2");
  write(1'000);
  watches_.Sweep();
  EXPECT_THAT(reader.TakeAll(), IsEmpty());
  write(6'000);
  watches_.Sweep();
  EXPECT_THAT(reader.TakeAll(), ElementsAre("+" + kRover));
}

}  // namespace
}  // namespace uplink::view
