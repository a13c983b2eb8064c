#include "server/view/config_json.h"

#include <string_view>

#include <absl/status/status.h>
#include <fmt/core.h>
#include <google/protobuf/util/json_util.h>

#include "server/view/json.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::view {
namespace {

std::string_view EffectText(config::Effect effect) {
  switch (effect) {
    case config::Effect::kRestart:
      return "restart";
    case config::Effect::kReload:
      return "reload";
    case config::Effect::kNone:
      break;
  }
  return "none";
}

absl::Status Fill(const config::EffectiveKey& key, v1::ConfigKey& message) {
  message.set_key(std::string(key.setting->key));
  // What TOML has for these values, JSON has too.
  const auto read = google::protobuf::util::JsonStringToMessage(key.value, message.mutable_value());
  if (!read.ok()) {
    return absl::InternalError(
        fmt::format("{} has no JSON form: {}", key.setting->key, std::string(read.message())));
  }
  message.set_effect(std::string(EffectText(key.setting->effect)));
  if (key.place.empty()) {
    message.set_source("default");
  } else if (key.place == config::kEnvironment) {
    message.set_source("environment");
    message.set_place(config::EnvironmentName(*key.setting));
  } else {
    message.set_source("file");
    message.set_place(key.place);
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::string> Encode(Form form, const config::InEffect& in_effect) {
  v1::ServerConfig message;
  message.set_file(in_effect.file());
  v1::ConfigSection* section = nullptr;
  for (const config::EffectiveKey& key : in_effect.Keys()) {
    if (section == nullptr || section->name() != key.setting->section) {
      section = message.add_sections();
      section->set_name(std::string(key.setting->section));
    }
    if (absl::Status filled = Fill(key, *section->add_keys()); !filled.ok()) return filled;
  }
  return Encode(form, message, {});
}

}  // namespace uplink::view
