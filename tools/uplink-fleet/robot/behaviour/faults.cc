#include "tools/uplink-fleet/robot/behaviour/faults.h"

#include <array>
#include <utility>

#include <fmt/core.h>

namespace uplink::synthetic {
namespace {

struct Kind {
  std::string_view id;
  std::string_view category;
  model::FaultSeverity severity;
  std::string_view text;
  std::string_view action;
};
constexpr std::array<Kind, 8> kKinds = {
    {{"drive.overcurrent", "drive", model::FaultSeverity::kMajor, "left motor over its current",
      "look for something in the wheel"},
     {"lidar.blocked", "perception", model::FaultSeverity::kMajor, "the front lidar sees nothing",
      "clean the window"},
     {"gps.no_fix", "position", model::FaultSeverity::kMinor, "no fix for 5 s", ""},
     {"battery.cell_imbalance", "power", model::FaultSeverity::kMinor, "cells differ by 80 mV",
      "charge to full once"},
     {"brake.wear", "drive", model::FaultSeverity::kInfo, "brake pads at 20 %", "order pads"},
     {"mower.jam", "tool", model::FaultSeverity::kCritical, "the deck does not turn",
      "stop the robot and free the deck"},
     {"comms.lost_base", "comms", model::FaultSeverity::kMinor, "no corrections from the base", ""},
     {"tilt.limit", "safety", model::FaultSeverity::kCritical, "tilted over 25 degrees",
      "bring the robot to level ground"}}};
/// Of an active fault: reported once more rather than cleared.
constexpr double kRaisedAgain = 0.25;

}  // namespace

Faults::Faults(Seeded random, std::string mark, std::string source, double rate_hz)
    : random_(random), mark_(std::move(mark)), source_(std::move(source)), rate_hz_(rate_hz) {}

model::Fault Faults::Report(const Moment& moment, std::size_t kind, bool active) {
  const Kind& of = kKinds.at(kind);
  model::Fault fault;
  fault.unix_time_ms = moment.now_ms;
  fault.fault_id = of.id;
  fault.source = source_;
  fault.severity = of.severity;
  fault.active = active;
  fault.category = of.category;
  fault.description = fmt::format("{} ({} report {})", of.text, mark_, ++reports_);
  if (active) fault.suggested_action = of.action;
  return fault;
}

model::Fault Faults::Sample(const Moment& moment) {
  return Report(moment, random_.Below(kKinds.size()), true);
}

void Faults::Advance(const Moment& moment, Facts& facts, Outbox& out) {
  double due = rate_hz_ * moment.dt_s;
  do {
    if (random_.Chance(due)) Change(moment, facts, out);
  } while (--due > 0);
}

void Faults::Change(const Moment& moment, Facts& facts, Outbox& out) {
  const std::size_t kind = random_.Below(kKinds.size());
  const bool was_active = active_.contains(kind);
  const bool active = !was_active || random_.Chance(kRaisedAgain);
  model::Fault fault = Report(moment, kind, active);
  const std::string code = fault.fault_id;
  const std::string description = fault.description;
  out.emplace_back(std::move(fault));
  if (active && !was_active) {
    active_.insert(kind);
    out.emplace_back(
        model::EventTelemetry{moment.now_ms, model::FaultRaisedEvent{code, description}});
  } else if (!active) {
    active_.erase(kind);
    out.emplace_back(model::EventTelemetry{moment.now_ms, model::FaultClearedEvent{code}});
  }
  facts.faulted = !active_.empty();
}

}  // namespace uplink::synthetic
