#include "tools/uplink-fleet/robot/behaviour/settings.h"

#include <cmath>
#include <string>
#include <utility>
#include <variant>

namespace uplink::synthetic {
namespace {

using enum model::ValueType;

constexpr double kChangeEveryS = 15;

model::UiCapabilities Capabilities() {
  model::UiCapabilities ui;
  ui.services = {{.name = "return_to_base",
                  .description = "ends the mission and drives to the base",
                  .capability_type = model::CapabilityType::kTrigger,
                  .confirmation_message = "End the mission?",
                  .state_key = "",
                  .requires_role = model::Role::kOperator,
                  .danger_level = model::DangerLevel::kWarning},
                 {.name = "blade",
                  .description = "the cutting deck",
                  .capability_type = model::CapabilityType::kSetBool,
                  .confirmation_message = std::nullopt,
                  .state_key = "blade",
                  .requires_role = model::Role::kAdmin,
                  .danger_level = model::DangerLevel::kCritical}};
  ui.sensors = {{.key = "deckRpm",
                 .label = "Deck",
                 .value_type = kInt,
                 .unit = "1/min",
                 .range = model::Range{.min = 0, .max = 4000},
                 .display_hint = model::DisplayHint::kGauge},
                {.key = "deckTemperature",
                 .label = "Deck",
                 .value_type = kNumber,
                 .unit = "C",
                 .range = std::nullopt,
                 .display_hint = model::DisplayHint::kTemperature},
                {.key = "blade",
                 .label = "Blade",
                 .value_type = kBool,
                 .unit = "",
                 .range = std::nullopt,
                 .display_hint = model::DisplayHint::kOnOff}};
  ui.settings = {{.key = "maxSpeed",
                  .label = "Speed",
                  .value_type = kNumber,
                  .default_value = 1.5,
                  .range = model::Range{.min = 0.5, .max = 3},
                  .step = 0.25},
                 {.key = "passes",
                  .label = "Passes",
                  .value_type = kInt,
                  .default_value = std::int32_t{2},
                  .range = model::Range{.min = 1, .max = 6},
                  .step = 1},
                 {.key = "lights",
                  .label = "Lights",
                  .value_type = kBool,
                  .default_value = false,
                  .range = std::nullopt,
                  .step = std::nullopt},
                 {.key = "pattern",
                  .label = "Pattern",
                  .value_type = kEnum,
                  .default_value = model::EnumName{"stripes"},
                  .range = std::nullopt,
                  .step = std::nullopt},
                 {.key = "nickname",
                  .label = "Name",
                  .value_type = kString,
                  .default_value = std::string("Mäher"),
                  .range = std::nullopt,
                  .step = std::nullopt}};
  return ui;
}

}  // namespace

Settings::Settings(Seeded random)
    : random_(random),
      capabilities_(Capabilities()),
      change_(kChangeEveryS, random_.Between(3, kChangeEveryS)) {
  for (const model::SettingDescriptor& setting : capabilities_.settings) {
    current_.settings.push_back({.key = setting.key, .value = setting.default_value});
  }
}

void Settings::ChangeOne() {
  const std::size_t chosen = random_.Below(current_.settings.size());
  const model::SettingDescriptor& of = capabilities_.settings[chosen];
  model::Value& value = current_.settings[chosen].value;
  switch (of.value_type) {
    case kNumber:
    case kInt: {
      const double steps = std::floor((of.range->max - of.range->min) / *of.step);
      const double to =
          of.range->min +
          *of.step * static_cast<double>(random_.Below(static_cast<std::size_t>(steps) + 1));
      if (of.value_type == kInt) {
        value = static_cast<std::int32_t>(to);
      } else {
        value = to;
      }
      break;
    }
    case kBool:
      value = !std::get<bool>(value);
      break;
    case kEnum:
      value = model::EnumName{random_.Chance(0.5) ? "spiral" : "stripes"};
      break;
    case kString:
      value = std::string(random_.Chance(0.5) ? "Mäher 2" : "草刈機");
      break;
  }
}

void Settings::Advance(const Moment& moment, Outbox& out) {
  if (!std::exchange(told_, true)) {
    out.emplace_back(capabilities_);
    out.emplace_back(current_);
  }
  if (!change_.Passed(moment.dt_s)) return;
  ChangeOne();
  out.emplace_back(current_);
}

}  // namespace uplink::synthetic
