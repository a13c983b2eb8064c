#include "storage/numbers.h"

namespace uplink::storage {

RunClosed RunClosedOf(std::int64_t column) {
  for (const RunClosed closed : {RunClosed::kNot, RunClosed::kForBound}) {
    if (static_cast<std::int64_t>(closed) == column) return closed;
  }
  return RunClosed::kForAge;
}

model::Presence PresenceOf(std::int64_t column) {
  for (const model::Presence presence : {model::Presence::kOnline, model::Presence::kOffline}) {
    if (static_cast<std::int64_t>(presence) == column) return presence;
  }
  return model::Presence::kUnknown;
}

model::ScopeKind ScopeKindOf(std::int64_t column) {
  return column == static_cast<std::int64_t>(model::ScopeKind::kWorkflowRun)
             ? model::ScopeKind::kWorkflowRun
             : model::ScopeKind::kEnvironment;
}

model::MessageSource MessageSourceOf(std::int64_t column) {
  for (const model::MessageSource source : model::kAllMessageSources) {
    if (static_cast<std::int64_t>(source) == column) return source;
  }
  return model::MessageSource::kUplink;
}

model::OperatorRequestKind OperatorRequestKindOf(std::int64_t column) {
  using enum model::OperatorRequestKind;
  return column == static_cast<std::int64_t>(kConfirmDeliveryComplete) ? kConfirmDeliveryComplete
                                                                       : kConfirmDeliveryReady;
}

model::ConnectionEnd ConnectionEndOf(std::int64_t column) {
  for (const model::ConnectionEnd end : model::kAllConnectionEnds) {
    if (static_cast<std::int64_t>(end) == column) return end;
  }
  return model::ConnectionEnd::kBroken;
}

AuditProof AuditProofOf(std::int64_t column) {
  for (const AuditProof proof :
       {AuditProof::kLocal, AuditProof::kToken, AuditProof::kCertificate, AuditProof::kStore}) {
    if (static_cast<std::int64_t>(proof) == column) return proof;
  }
  return AuditProof::kServer;
}

model::RejectReason ReasonOf(std::int64_t column) {
  for (const model::RejectReason reason : model::kAllRejectReasons) {
    if (static_cast<std::int64_t>(reason) == column) return reason;
  }
  return model::RejectReason::kStoreRefused;
}

}  // namespace uplink::storage
