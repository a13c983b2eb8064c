#pragma once

#include <span>
#include <string_view>

namespace uplink::synthetic {

/// A file of tests/load/scenarios, as it was when the program was built.
struct ScenarioFile {
  std::string_view name;
  std::string_view text;
};

/// By name; made by embed_scenarios.cmake.
[[nodiscard]] std::span<const ScenarioFile> ScenarioFiles();

}  // namespace uplink::synthetic
