#pragma once

#include <string>

#include "server/identity/caller.h"
#include "storage/audit.h"

namespace uplink::admin {

/// Who gives a command, and from where. A value.
struct Asker {
  identity::Caller caller = identity::LocalCaller();
  storage::AuditProof proof = storage::AuditProof::kLocal;
  /// Its address; empty: this machine.
  std::string from{};
};

/// A caller of the API.
[[nodiscard]] Asker AskerOf(const identity::Caller& caller, std::string from);
/// The user of a program that has the store itself, on this machine.
[[nodiscard]] Asker StoreAsker(std::string user, std::string machine);

}  // namespace uplink::admin
