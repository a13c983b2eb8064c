#pragma once

#include <string>
#include <vector>

#include "tools/uplink-fleet/compare/verify.h"

namespace uplink::synthetic {

/// What the rows that do not agree are about, in their order.
[[nodiscard]] inline std::vector<std::string> MismatchesOf(const std::vector<CheckRow>& rows) {
  std::vector<std::string> names;
  for (const CheckRow& row : rows) {
    if (!row.ok) names.push_back(row.what);
  }
  return names;
}

}  // namespace uplink::synthetic
