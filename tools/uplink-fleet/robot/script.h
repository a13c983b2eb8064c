#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tools/uplink-fleet/robot/account.h"
#include "tools/uplink-fleet/robot/agent_model.h"
#include "tools/uplink-fleet/robot/behaviour/arm.h"
#include "tools/uplink-fleet/robot/behaviour/battery.h"
#include "tools/uplink-fleet/robot/behaviour/controls.h"
#include "tools/uplink-fleet/robot/behaviour/coverage.h"
#include "tools/uplink-fleet/robot/behaviour/equipment.h"
#include "tools/uplink-fleet/robot/behaviour/faults.h"
#include "tools/uplink-fleet/robot/behaviour/missions.h"
#include "tools/uplink-fleet/robot/behaviour/objects.h"
#include "tools/uplink-fleet/robot/behaviour/route.h"
#include "tools/uplink-fleet/robot/behaviour/settings.h"
#include "tools/uplink-fleet/robot/behaviour/sharing.h"
#include "tools/uplink-fleet/robot/wrong.h"
#include "tools/uplink-fleet/scenario/scenario.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::synthetic {

/// One robot's seeded life: its behaviours, step by step. Each message is entered into the account
/// as it is made. The same seed and index give the same messages but for times and marks.
///
/// Thread: confined to the robot's thread.
class RobotScript final {
 public:
  RobotScript(const ScenarioOptions& options, std::size_t index);

  /// The robot's RURI. One without sends no RCAN Robot States: they name it.
  void Name(std::string ruri) { ruri_ = std::move(ruri); }
  /// Goes on with other rates, shares and pace; who the robot is stays.
  void Adopt(const ScenarioOptions& options);
  /// The messages of one tick, at `now_ms` (Unix).
  [[nodiscard]] std::vector<Outgoing> Tick(std::int64_t now_ms, Account& account);
  /// The same of a robot that moves and reports nothing else.
  [[nodiscard]] Outgoing OnlyMove(std::int64_t now_ms, Account& account);
  /// A motion message of a robot that stands still.
  [[nodiscard]] Outgoing Motion(std::int64_t now_ms, Account& account);
  /// A motion message between two ticks.
  [[nodiscard]] Outgoing Again(std::int64_t now_ms, Account& account);
  /// What the server asks for, as it is now.
  [[nodiscard]] std::vector<Outgoing> Answer(const v1::ResendRequest& request, Account& account);
  /// One of each live message, with every key.
  [[nodiscard]] std::vector<Outgoing> Last(std::int64_t now_ms, Account& account);

 private:
  RobotScript(const ScenarioOptions& options, std::size_t index, const std::string& mark);
  [[nodiscard]] model::StatusTelemetry Status(const Moment& moment) const;
  [[nodiscard]] bool HasArm() const;
  [[nodiscard]] Outgoing ArmState(const Moment& moment, Account& account);

  ScenarioOptions options_;
  std::size_t index_;
  std::string ruri_;
  double tick_s_;
  Seeded random_;
  Facts facts_;
  Route route_;
  Battery battery_;
  Controls controls_;
  Missions missions_;
  Faults faults_;
  Coverage coverage_;
  Objects objects_;
  Sharing sharing_;
  Settings settings_;
  Equipment equipment_;
  Wrong wrong_;
  Every status_;
  Arm arm_;
  Every arm_state_;
};

/// What every id of a robot of a run begins with.
[[nodiscard]] std::string MarkOf(const std::string& run, std::size_t index);
/// The source of the faults of a run.
[[nodiscard]] std::string SourceOf(const std::string& run);

}  // namespace uplink::synthetic
