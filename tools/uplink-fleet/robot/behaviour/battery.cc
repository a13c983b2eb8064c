#include "tools/uplink-fleet/robot/behaviour/battery.h"

#include <algorithm>

#include <fmt/core.h>

namespace uplink::synthetic {
namespace {

constexpr double kCapacityAh = 40;
constexpr double kDesignAh = 42;
constexpr double kEmptyV = 22;
constexpr double kFullV = 26;
constexpr double kLowPct = 15;
constexpr double kChargedPct = 90;
// Currents that empty it in twenty minutes and fill it in five: a run is short.
constexpr double kDriveA = -120;
constexpr double kIdleA = -6;
constexpr double kChargeA = 480;
constexpr double kSecondsAnHour = 3600;

}  // namespace

Battery::Battery(Seeded random) : soc_pct_(random.Between(kLowPct, 100)) {}

void Battery::Advance(const Moment& moment, Facts& facts, Outbox& out) {
  current_a_ = facts.charging ? kChargeA : facts.speed_mps > 0 ? kDriveA : kIdleA;
  soc_pct_ = std::clamp(soc_pct_ + 100 * current_a_ * moment.dt_s / kSecondsAnHour / kCapacityAh,
                        0.0, 100.0);
  if (!facts.charging && soc_pct_ < kLowPct) {
    facts.charging = true;
    ++facts.charge_cycles;
    out.emplace_back(
        model::Message{.unix_time_ms = moment.now_ms,
                       .level = model::MessageLevel::kWarn,
                       .message = fmt::format("battery at {:.0f} %: going to charge", soc_pct_)});
  } else if (facts.charging && soc_pct_ >= kChargedPct) {
    facts.charging = false;
    out.emplace_back(model::Message{.unix_time_ms = moment.now_ms,
                                    .level = model::MessageLevel::kInfo,
                                    .message = "charged: going on"});
  }
  facts.soc_pct = soc_pct_;
}

model::BatteryStatus Battery::Status(const Facts& facts) const {
  model::BatteryStatus status;
  status.soc_pct = static_cast<float>(soc_pct_);
  status.voltage_v = static_cast<float>(kEmptyV + (kFullV - kEmptyV) * soc_pct_ / 100);
  status.current_a = static_cast<float>(current_a_);
  status.charge_ah = static_cast<float>(kCapacityAh * soc_pct_ / 100);
  status.capacity_ah = static_cast<float>(kCapacityAh);
  status.design_capacity_ah = static_cast<float>(kDesignAh);
  status.temperature = static_cast<float>(20 + (facts.charging ? 8 : 3));
  status.power_supply_status =
      facts.charging ? model::PowerSupplyStatus::kCharging : model::PowerSupplyStatus::kDischarging;
  status.power_supply_health = model::PowerSupplyHealth::kGood;
  status.power_supply_technology = model::PowerSupplyTechnology::kLiFe;
  return status;
}

}  // namespace uplink::synthetic
