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
                  .danger_level = model::DangerLevel::kWarning}};
  ui.sensors = {{.key = "deckRpm",
                 .label = "Deck",
                 .value_type = kInt,
                 .unit = "1/min",
                 .range = model::Range{.min = 0, .max = 4000},
                 .display_hint = model::DisplayHint::kGauge}};
  const auto declare = [&ui](const char* key, model::Value value) -> model::SettingDescriptor& {
    const model::ValueType type = model::TypeOf(value);
    return ui.settings.emplace_back(model::SettingDescriptor{.key = key,
                                                             .label = key,
                                                             .value_type = type,
                                                             .default_value = std::move(value),
                                                             .range = std::nullopt,
                                                             .step = std::nullopt});
  };
  model::SettingDescriptor& speed = declare("maxSpeed", 1.5);
  speed.range = model::Range{.min = 0.5, .max = 3};
  speed.step = 0.25;
  model::SettingDescriptor& passes = declare("passes", std::int32_t{2});
  passes.range = model::Range{.min = 1, .max = 6};
  passes.step = 1;
  declare("lights", false);
  declare("pattern", model::EnumName{"stripes"});
  declare("nickname", std::string("Mäher"));
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
