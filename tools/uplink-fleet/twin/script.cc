#include "tools/uplink-fleet/twin/script.h"

#include <array>
#include <cstddef>

namespace uplink::synthetic {
namespace {

/// Of all messages, those that are stored, and those that are wrong.
constexpr double kStoredShare = 0.25;
constexpr double kWrongShare = 0.02;
constexpr std::uint64_t kScriptSalt = 0x7477'696e'5f73'6179ULL;

/// An index into `weights`, as often as they say.
template <std::size_t N>
std::size_t Choose(Seeded& chance, const std::array<unsigned, N>& weights) {
  std::size_t sum = 0;
  for (const unsigned weight : weights) sum += weight;
  std::size_t left = chance.Below(sum);
  for (std::size_t i = 0; i < N; ++i) {
    if (left < weights[i]) return i;
    left -= weights[i];
  }
  return 0;
}

}  // namespace

TwinScript::TwinScript(const TwinOptions& options)
    : voice_(options),
      chance_(Seeded(options.seed ^ kScriptSalt).Next() + options.index),
      poses_({voice_, account_, chance_}),
      joints_({voice_, account_, chance_}),
      reports_({voice_, account_, chance_}),
      happenings_({voice_, account_, chance_}),
      runs_({voice_, account_, chance_}),
      wrongs_({voice_, account_, chance_}) {}

std::vector<Publication> TwinScript::First(std::int64_t now_us) {
  voice_.SetNow(now_us);
  std::vector<Publication> first;
  for (const Speaker speaker : {Speaker::kDriver, Speaker::kSimulation}) {
    first.push_back(happenings_.Connected(speaker));
    first.push_back(happenings_.TelemetryStart(speaker));
  }
  // Who subscribes later gets it, and must not take it for news.
  first.push_back(poses_.Scale());
  first.back().retain = true;
  first.push_back(poses_.SimulatedPosition());
  return first;
}

Publication TwinScript::Next(std::int64_t now_us) {
  voice_.SetNow(now_us);
  const double what = chance_.Unit();
  if (account_.Full() || what >= kStoredShare + kWrongShare) return Shown();
  return what < kWrongShare ? wrongs_.Next() : Stored();
}

Publication TwinScript::Stored() {
  switch (Choose(chance_, std::array<unsigned, 13>{4, 2, 4, 2, 3, 2, 1, 1, 4, 3, 2, 2, 1})) {
    case 0:
      return happenings_.Event();
    case 1:
      return happenings_.FramedEvent();
    case 2:
      return happenings_.UnknownTelemetry();
    case 3:
      return happenings_.SimulatedTelemetry();
    case 4:
      return happenings_.DriverLog();
    case 5:
      return happenings_.TelemetryLog();
    case 6:
      return happenings_.Environment();
    case 7:
      return happenings_.WorkflowRun();
    case 8:
      return runs_.Navigate();
    case 9:
      return runs_.Mission();
    case 10:
      return reports_.MetricsWithErrors();
    case 11:
      return ViewerMark();
    default:
      return happenings_.IdleMark(chance_.Chance(0.5) ? Speaker::kDriver : Speaker::kSimulation);
  }
}

Publication TwinScript::ViewerMark() {
  viewer_there_ = !viewer_there_;
  if (viewer_there_) return happenings_.Connected(Speaker::kViewer);
  return chance_.Chance(0.5) ? happenings_.Disconnected(Speaker::kViewer)
                             : happenings_.TelemetryEnd(Speaker::kViewer);
}

Publication TwinScript::Shown() {
  switch (Choose(chance_, std::array<unsigned, 24>{10, 7, 6, 3, 1, 4, 1, 1, 8, 4, 6, 5,
                                                   4,  8, 2, 2, 1, 3, 2, 1, 1, 1, 1, 3})) {
    case 0:
      return poses_.Position();
    case 1:
      return poses_.SimulatedPosition();
    case 2:
      return poses_.Rotation();
    case 3:
      return poses_.SimulatedRotation();
    case 4:
      return poses_.Scale();
    case 5:
      return poses_.Gps();
    case 6:
      return poses_.LatePosition();
    case 7:
      return poses_.WantedPosition();
    case 8:
      return joints_.Single();
    case 9:
      return joints_.SinglePosition();
    case 10:
      return joints_.Follower();
    case 11:
      return joints_.Leader();
    case 12:
      return joints_.Simulated();
    case 13:
      return joints_.Flat();
    case 14:
      return joints_.States();
    case 15:
      return joints_.Setpoints();
    case 16:
      return joints_.Teleoperated();
    case 17:
      // Where no more may be remembered nothing may raise or clear a fault either.
      return account_.Full() ? poses_.Position() : reports_.Metrics();
    case 18:
      return reports_.DriverHealth();
    case 19:
      return reports_.ComputerHealth();
    case 20:
      return chance_.Chance(0.5) ? reports_.MotorStatus() : reports_.DriverInfo();
    case 21:
      return reports_.BatteryReport();
    case 22:
      return chance_.Chance(0.5) ? reports_.RobotState() : reports_.Command();
    default:
      return chance_.Chance(0.8) ? reports_.BatteryStatus() : reports_.Signalling();
  }
}

std::vector<Publication> TwinScript::Last(std::int64_t now_us) {
  voice_.SetNow(now_us);
  std::vector<Publication> last;
  // The retained one first: the empty message is one that the server may reject.
  Publication none;
  const Draft draft = voice_.BeginBare();
  none.number = draft.number;
  none.topic = voice_.Topic("twin/" + ids().twin + "/scale");
  none.retain = true;
  account_.Wrong(draft.number, {.reason = model::RejectReason::kMalformed,
                                .topic = none.topic,
                                .bytes = 0,
                                .of_no_robot = false,
                                .sure = false});
  last.push_back(std::move(none));
  last.push_back(poses_.Position());
  last.push_back(poses_.SimulatedPosition());
  last.push_back(poses_.Rotation());
  last.push_back(poses_.SimulatedRotation());
  last.push_back(poses_.Scale());
  last.push_back(poses_.Gps());
  last.push_back(joints_.Single());
  last.push_back(joints_.Follower());
  last.push_back(joints_.Leader());
  last.push_back(joints_.Simulated());
  last.push_back(joints_.Flat());
  last.push_back(joints_.States());
  last.push_back(reports_.MetricsWithErrors());
  last.push_back(reports_.DriverHealth());
  last.push_back(reports_.ComputerHealth());
  last.push_back(reports_.MotorStatus());
  last.push_back(reports_.DriverInfo());
  last.push_back(reports_.BatteryReport());
  last.push_back(reports_.RobotState());
  last.push_back(reports_.BatteryStatus());
  last.push_back(reports_.Command());
  // What must change nothing of the above, but for one channel.
  last.push_back(joints_.SinglePosition());
  last.push_back(joints_.Setpoints());
  last.push_back(joints_.Teleoperated());
  last.push_back(poses_.LatePosition());
  last.push_back(poses_.WantedPosition());
  last.push_back(reports_.Signalling());
  return last;
}

}  // namespace uplink::synthetic
