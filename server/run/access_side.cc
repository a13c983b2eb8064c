#include "server/run/access_side.h"

#include <cstdint>
#include <utility>

#include "server/admin/actions.h"
#include "server/admin/asker.h"
#include "server/admin/audit_rows.h"
#include "server/identity/expiry.h"
#include "server/transport/options.h"

namespace uplink::run {
namespace {

transport::PemFiles FilesOf(const AccessSide::Context& context) {
  return {.certificate = context.http.tls_certificate_file,
          .key = context.http.tls_key_file,
          .client_ca = config::OperatorCaFile(context.tls)};
}

transport::TlsRules RulesOf(const config::TlsConfig& tls) {
  return {.minimum = tls.min_version, .groups = config::ServedGroups(tls)};
}

}  // namespace

AccessSide::AccessSide(const Context& context)
    : context_(context),
      tokens_({.tokens = context.http.tokens_file, .scrape = context.http.metrics_token_file},
              context.logger),
      guard_({context.clock, context.logger, context.probe},
             {.asks = config::AsksForProof(context.http),
              .tokens = [this] { return tokens_.tokens(); },
              .first_use = [this](const identity::Caller& caller,
                                  const std::string& from) { NoteFirstUse(caller, from); }}) {
  if (config::SpeaksTls(context.http)) tls_.emplace(FilesOf(context), RulesOf(context.tls));
}

absl::Status AccessSide::Open() {
  if (tls_) {
    const transport::FilesLook look = tls_->Refresh();
    if (!look.status.ok()) return look.status;
  }
  return LookAtTokens();
}

std::vector<std::string> AccessSide::Look() {
  std::vector<std::string> problems;
  for (const absl::Status& looked : {tls_ ? LookAtTls() : absl::OkStatus(), LookAtTokens()}) {
    if (!looked.ok()) problems.emplace_back(looked.message());
  }
  return problems;
}

absl::Status AccessSide::LookAtTokens() {
  absl::Status looked = tokens_.Look();
  context_.probe.tokens.Set(static_cast<std::int64_t>(tokens_.tokens()->table.entries().size()));
  return looked;
}

void AccessSide::NoteFirstUse(const identity::Caller& caller, const std::string& from) {
  context_.audit.Note(admin::RowOf(
      admin::AskerOf(caller, from),
      {.action = admin::kFirstUse, .target = std::string(identity::ToText(caller.role))},
      absl::OkStatus(), context_.clock.System()));
}

absl::Status AccessSide::LookAtTls() {
  const transport::FilesLook look = tls_->Refresh();
  const std::string before = std::exchange(tls_why_, std::string(look.status.message()));
  if (!look.status.ok()) {
    if (before != tls_why_) {
      context_.logger.Error("http_certificate_mismatch", {{"why", tls_why_}});
    }
    return look.status;
  }
  const std::string& digest = look.served.certificate_sha256;
  const bool is_same = std::exchange(certificate_sha256_, digest) == digest;
  if (before.empty() && is_same) return absl::OkStatus();
  context_.logger.Info("http_certificate_served",
                       {{"expires", identity::ExpiryText(look.served.expiry)},
                        {"authorities", look.served.authorities},
                        {"certificate_sha256", digest},
                        {"client_ca_sha256", look.served.client_ca_sha256}});
  return absl::OkStatus();
}

}  // namespace uplink::run
