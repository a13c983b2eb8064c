#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/http/denied.h"
#include "server/http/routes.h"
#include "server/identity/caller.h"

namespace uplink::http {

/// Why a caller may not ask something. A value.
struct Forbidden {
  Denied why = Denied::kRole;
  /// What is needed, and who asks.
  std::string text;
};

/// Whether a role has a right.
[[nodiscard]] bool Has(identity::Role role, Right right);

/// Nothing if the caller may ask for what the route shows. Pure.
[[nodiscard]] std::optional<Forbidden> WhyForbidden(const Route& route,
                                                    const identity::Caller& caller);

/// The same of a certificate whose role opens nothing here: a robot's, a gateway's.
[[nodiscard]] Forbidden WhyForbidden(const Route& route, identity::Role role,
                                     const std::string& name);

}  // namespace uplink::http
