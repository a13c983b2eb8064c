#include "tools/uplink-fleet/scenario.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "schema/encode.h"
#include "schema/limits.h"

namespace uplink::synthetic {
namespace {

constexpr std::int32_t kDegree = 65'536;
constexpr std::int32_t kPercent = 16;
/// Ids among which a robot's faults come and go.
constexpr auto kFaultIds = std::to_array<std::string_view>(
    {"drive.overcurrent", "lidar.blocked", "gps.no_fix", "battery.cell_imbalance", "brake.wear",
     "mower.jam", "comms.lost_base", "tilt.limit"});

double Degrees(std::int32_t units) { return static_cast<double>(units) / kDegree; }

Outgoing Durable(const model::Body& body, std::uint64_t tag) {
  return {Keeping::kDurable, Content::kRoverNexus, schema::Encode(body), tag};
}

Outgoing Live(const model::Body& body) {
  return {Keeping::kLive, Content::kRoverNexus, schema::Encode(body), 0};
}

}  // namespace

RobotScript::RobotScript(const ScenarioOptions& options, std::size_t index)
    : options_(options),
      index_(index),
      random_(options.seed * 0x9E37'79B9'7F4A'7C15ULL + index),
      lat_(47 * kDegree + static_cast<std::int32_t>(random_() % 4096)),
      lon_(8 * kDegree + static_cast<std::int32_t>(random_() % 4096)),
      charge_(50 * kPercent + static_cast<std::int32_t>(random_() % 512)) {}

bool RobotScript::Chance(double probability) {
  return std::uniform_real_distribution<double>(0, 1)(random_) < probability;
}

std::vector<Outgoing> RobotScript::Tick(std::int64_t now_ms, Ledger& ledger) {
  const auto ticks_a_second =
      static_cast<std::uint64_t>(std::max(1.0, std::round(options_.rate_hz)));
  std::vector<Outgoing> messages;
  const bool room = ledger.faults.size() + ledger.wrongs.size() < kReportsMax;
  if (room && Chance(options_.malformed_share)) {
    messages.push_back(Wrong(now_ms, ledger));
  } else {
    messages.push_back(Motion(now_ms, ledger));
  }
  // Statuses of different robots fall on different ticks.
  if ((ticks_ + index_) % ticks_a_second == 0) messages.push_back(Status(now_ms, ledger));
  if (room && Chance(options_.faults_hz / options_.rate_hz)) {
    messages.push_back(FaultMessage(now_ms, ledger));
  }
  ++ticks_;
  return messages;
}

Outgoing RobotScript::Motion(std::int64_t now_ms, Ledger& ledger) {
  lat_ += static_cast<std::int32_t>(random_() % 7) - 3;
  lon_ += static_cast<std::int32_t>(random_() % 7) - 3;
  model::MotionTelemetry motion;
  motion.unix_time_ms = now_ms;
  motion.pose =
      model::Pose{Degrees(lat_), Degrees(lon_), 400.0 + static_cast<double>(random_() % 64) / 8,
                  static_cast<double>(random_() % 2880) / 8};
  motion.velocity = model::VelTwist{static_cast<float>(random_() % 32) / 16.0F,
                                    static_cast<float>(random_() % 16) / 16.0F - 0.5F};
  motion.gps_fix_type = model::GpsFixType::kFixedRtk;
  motion.gps_source = model::GpsSource::kSimulated;
  ledger.last_motion = motion;
  ++ledger.live_offered;
  return Live(motion);
}

Outgoing RobotScript::Status(std::int64_t now_ms, Ledger& ledger) {
  charge_ = std::clamp(charge_ + static_cast<std::int32_t>(random_() % 3) - 1, 0, 100 * kPercent);
  model::StatusTelemetry status;
  status.unix_time_ms = now_ms;
  status.battery = model::BatteryStatus();
  status.battery->soc_pct = static_cast<float>(charge_) / kPercent;
  status.battery->voltage_v = 24.5F;
  status.battery->power_supply_status = model::PowerSupplyStatus::kDischarging;
  status.mode = model::RobotMode::kAuto;
  status.estop = model::EStop{now_ms, false, {}};
  status.faulted = !ledger.active.empty();
  status.mission_active = true;
  status.status = fmt::format("synthetic robot {}", index_ + 1);
  ledger.last_status = status;
  ++ledger.live_offered;
  return Live(status);
}

model::Fault RobotScript::NewFault(std::int64_t now_ms, bool active, const std::string& id) {
  model::Fault fault;
  fault.unix_time_ms = now_ms;
  fault.fault_id = id;
  fault.source = fmt::format("uplink-fleet/{}", options_.run);
  fault.severity = static_cast<model::FaultSeverity>(random_() % 4);
  fault.active = active;
  fault.category = "synthetic";
  fault.description = fmt::format("run {} robot {} report {}", options_.run, index_ + 1, next_tag_);
  fault.suggested_action = active ? "none: this robot is not real" : "";
  return fault;
}

Outgoing RobotScript::FaultMessage(std::int64_t now_ms, Ledger& ledger) {
  const std::string id(kFaultIds[random_() % kFaultIds.size()]);
  model::Fault fault = NewFault(now_ms, true, id);
  const std::pair<std::string, std::string> key{fault.fault_id, fault.source};
  // An active fault is taken back three times of four, else reported once more.
  if (ledger.active.count(key) != 0 && random_() % 4 != 0) fault = NewFault(now_ms, false, id);
  const std::uint64_t tag = next_tag_++;
  if (fault.active) {
    ledger.active[key] = fault.description;
  } else {
    ledger.active.erase(key);
  }
  Outgoing message = Durable(fault, tag);
  ledger.open_faults[tag] = fault.description;
  ledger.faults[fault.description] = {fault, false};
  return message;
}

Outgoing RobotScript::Wrong(std::int64_t now_ms, Ledger& ledger) {
  model::Fault fault = NewFault(now_ms, true, "wrong.on_purpose");
  const std::uint64_t tag = next_tag_++;
  WrongReport report;
  Outgoing message;
  switch (random_() % 5) {
    case 0:
      fault.fault_id.clear();
      report = {model::RejectReason::kMissingField, "faultId", 0, false, {}};
      message = Durable(fault, tag);
      break;
    case 1:
      fault.description.assign(schema::kDescriptionBytesMax + 1, 'x');
      report = {model::RejectReason::kTextTooLong, "description", 0, false, {}};
      message = Durable(fault, tag);
      break;
    case 2:
      fault.category = "\xC3\x28";
      report = {model::RejectReason::kTextNotUtf8, "category", 0, false, {}};
      message = Durable(fault, tag);
      break;
    case 3:
      // Cut in the middle: the segment table promises more than there is.
      message = Durable(fault, tag);
      message.payload.resize(message.payload.size() / 2);
      break;
    default:
      report = {model::RejectReason::kUnsupportedContent, "", 0, false, {}};
      message = {Keeping::kDurable, Content::kNone, "", tag};
      break;
  }
  ledger.wrongs[tag] = std::move(report);
  return message;
}

}  // namespace uplink::synthetic
