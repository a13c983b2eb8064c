#include "server/admin/audit_rows.h"

#include "schema/base/utf8.h"
#include "server/admin/actions.h"

namespace uplink::admin {
namespace {

std::string Shown(std::string_view text) {
  return PrintableUtf8(text, storage::kAuditTextBytesMax);
}

std::string OutcomeOf(const absl::Status& outcome) {
  return outcome.ok() ? std::string(kOutcomeOk) : absl::StatusCodeToString(outcome.code());
}

}  // namespace

storage::AuditRow RowOf(const Asker& asker, const Deed& deed, const absl::Status& outcome,
                        SystemTime at) {
  return {.at = at,
          .proof = asker.proof,
          .who = Shown(asker.caller.name),
          .from = Shown(asker.from),
          .action = std::string(deed.action),
          .target = Shown(deed.target),
          .fleet = Shown(deed.fleet),
          .outcome = OutcomeOf(outcome),
          .detail = Shown(deed.detail)};
}

storage::AuditRow RowOfServer(std::string_view server, const Deed& deed, SystemTime at) {
  Asker asker{.proof = storage::AuditProof::kServer};
  asker.caller.name = server;
  return RowOf(asker, deed, absl::OkStatus(), at);
}

std::string_view ToText(storage::AuditProof proof) {
  switch (proof) {
    case storage::AuditProof::kLocal:
      return "local";
    case storage::AuditProof::kToken:
      return "token";
    case storage::AuditProof::kCertificate:
      return "certificate";
    case storage::AuditProof::kStore:
      return "store";
    case storage::AuditProof::kServer:
      return "server";
  }
  return "";
}

}  // namespace uplink::admin
