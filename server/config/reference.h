#pragma once

#include <string>

namespace uplink::config {

/// `deploy/uplinkd.toml`: every key that has an effect, commented, with its text and default.
[[nodiscard]] std::string ExampleToml();

/// The table of `docs/operate/configuration.md`, with the same keys: key, default, what it takes,
/// text.
[[nodiscard]] std::string SettingsTable();

}  // namespace uplink::config
