#include "server/admin/asker.h"

#include <utility>

namespace uplink::admin {
namespace {

storage::AuditProof ProofOf(identity::Proof proof) {
  switch (proof) {
    case identity::Proof::kNone:
      break;
    case identity::Proof::kToken:
      return storage::AuditProof::kToken;
    case identity::Proof::kCertificate:
      return storage::AuditProof::kCertificate;
  }
  return storage::AuditProof::kLocal;
}

}  // namespace

Asker AskerOf(const identity::Caller& caller, std::string from) {
  return {.caller = caller, .proof = ProofOf(caller.proof), .from = std::move(from)};
}

Asker StoreAsker(std::string user, std::string machine) {
  Asker asker{.proof = storage::AuditProof::kStore, .from = std::move(machine)};
  asker.caller.name = std::move(user);
  return asker;
}

}  // namespace uplink::admin
