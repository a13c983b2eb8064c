#pragma once

#include <string_view>
#include <vector>

#include "server/config/config.h"

namespace uplink::config {

/// A broken rule between values that are each within their own bounds.
struct Breach {
  /// The key that the operator should look at first.
  std::string_view section;
  std::string_view key;
  std::string text;
};

/// What one setting's bounds cannot say: required keys, relations between limits, addresses that
/// exclude each other, values that this version does not serve. Pure.
[[nodiscard]] std::vector<Breach> CheckRelations(const Config& config);

}  // namespace uplink::config
