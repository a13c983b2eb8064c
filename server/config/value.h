#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "server/config/settings.h"

namespace uplink::config {

/// Why a value was not taken: one sentence with the value (unless secret) and what is allowed.
struct BadValue {
  std::string text;
};

using Interpreted = std::variant<Value, BadValue>;

/// Reads a setting from a string: every kind from the environment; sizes, durations, texts, files,
/// choices and addresses from TOML. Bounds are checked.
[[nodiscard]] Interpreted InterpretText(const Setting& setting, std::string_view text);

/// Reads a list, or networks, from its items. Its bounds are checked, that no item stands in it
/// twice, and that none is empty unless the setting allows that.
[[nodiscard]] Interpreted InterpretList(const Setting& setting, std::vector<std::string> items);

/// Reads a count from a TOML integer. Bounds are checked.
[[nodiscard]] Interpreted InterpretInteger(const Setting& setting, std::int64_t number);

}  // namespace uplink::config
