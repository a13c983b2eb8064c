#pragma once

#include <memory>
#include <string>

#include "server/identity/scope.h"

namespace uplink::identity {

/// The fleets that an authority may vouch for. A value.
struct FleetBounds {
  /// What operators call it.
  std::string authority;
  Scope fleets;
};

/// Null: every fleet.
using FleetBoundsPtr = std::shared_ptr<const FleetBounds>;

}  // namespace uplink::identity
