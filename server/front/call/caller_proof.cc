#include "server/front/call/caller_proof.h"

#include <utility>

namespace uplink::front {

transport::CallerProof ProofOf(const TlsPeer& peer, const Origin& origin,
                               std::string authorization) {
  transport::CallerProof proof{.authorization = std::move(authorization),
                               .source = origin.source.bytes(),
                               .from = origin.text};
  if (peer.anonymous) return proof;
  proof.identity = peer.identity;
  proof.expiry = peer.expiry;
  for (const std::string* name : {&peer.subject, &peer.gateway, &peer.ruri}) {
    if (proof.subject.empty()) proof.subject = *name;
  }
  return proof;
}

}  // namespace uplink::front
