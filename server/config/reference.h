#pragma once

#include <string>

namespace uplink::config {

/// `deploy/uplinkd.toml`: every key, commented, with its text and default.
[[nodiscard]] std::string ExampleToml();

/// The table of `docs/operate/configuration.md`: key, default, what it takes, text.
[[nodiscard]] std::string SettingsTable();

}  // namespace uplink::config
