#pragma once

#include <cstdint>
#include <string>

#include "server/identity/peer_identity.h"
#include "server/identity/scope.h"

namespace uplink::identity {

/// How a caller showed who it is.
enum class Proof : std::uint8_t {
  /// Nothing is asked for: no operator has set up authentication, and only this machine gets here.
  kNone,
  kToken,
  kCertificate,
};

/// Who asks, and what it may see. Its role is never kRobot or kGateway. A value.
struct Caller {
  Role role = Role::kViewer;
  Scope scope = Scope::Of({});
  Proof proof = Proof::kNone;
  /// The id of its token, or the subject of its certificate; `local` without proof.
  std::string name;
  /// What its token is for, in the operator's words. The file loses it with the token.
  std::string note{};
};

/// A caller that no authentication stands before: everything is open to it.
[[nodiscard]] inline Caller LocalCaller() {
  return {.role = Role::kAdmin, .scope = Scope::All(), .proof = Proof::kNone, .name = "local"};
}

}  // namespace uplink::identity
