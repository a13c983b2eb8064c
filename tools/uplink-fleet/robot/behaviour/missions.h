#pragma once

#include <cstdint>
#include <string>

#include "schema/model/mission.h"
#include "tools/uplink-fleet/robot/behaviour/facts.h"
#include "tools/uplink-fleet/robot/behaviour/route.h"
#include "tools/uplink-fleet/robot/behaviour/seeded.h"

namespace uplink::synthetic {

/// Missions, one after the other: ready, starting, running step by step, paused while the robot may
/// not drive, and complete, aborted or failed at the end; with the events that belong to it. Some
/// are of the robot's own and have no mission id; some send one more report after their end.
class Missions final {
 public:
  /// Run ids begin with `mark`.
  Missions(Seeded random, std::string mark) : random_(random), mark_(std::move(mark)) {}

  void Advance(const Moment& moment, Facts& facts, const Route& route, Outbox& out);
  /// Numbers runs from 1; 0 before the first.
  [[nodiscard]] std::uint32_t runs() const { return runs_; }

 private:
  void Begin(const Moment& moment, Facts& facts, Outbox& out);
  void Step(const Moment& moment, Facts& facts, const Route& route, Outbox& out);
  void End(const Moment& moment, Facts& facts, Outbox& out);
  void Report(const Moment& moment, model::MissionStatus status, Outbox& out);
  void Tell(const Moment& moment, model::MessageLevel level, const std::string& what,
            Outbox& out) const;

  Seeded random_;
  std::string mark_;
  model::MissionRunStatus report_;
  std::uint32_t runs_ = 0;
  /// Seconds until the next thing happens.
  double left_s_ = 1;
  bool late_report_ = false;
};

}  // namespace uplink::synthetic
