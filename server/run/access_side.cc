#include "server/run/access_side.h"

#include <cstdint>
#include <utility>
#include <vector>

#include "server/admin/actions.h"
#include "server/admin/asker.h"
#include "server/admin/audit_rows.h"
#include "server/config/authority_folder.h"
#include "server/identity/expiry.h"
#include "server/transport/options.h"

namespace uplink::run {
namespace {

transport::PemFiles FilesOf(const AccessSide::Context& context) {
  return {.certificate = context.http.tls_certificate_file,
          .key = context.http.tls_key_file,
          .client_ca = config::OperatorCaFile(context.tls),
          .authorities = context.identity.authorities,
          // Operators' own authorities stand alone; one that has an entry may do no more than that.
          .entries_alone = !context.tls.operator_ca_file.empty()};
}

transport::TlsRules RulesOf(const config::TlsConfig& tls) {
  return {.minimum = tls.min_version, .groups = config::ServedGroups(tls)};
}

}  // namespace

AccessSide::AccessSide(const Context& context)
    : context_(context),
      tokens_({.tokens = context.http.tokens_file, .scrape = context.http.metrics_token_file},
              context.logger),
      lists_([this] { return ListsNow(); }, context.clock, context.logger),
      guard_({context.clock, context.logger, context.probe},
             {.asks = config::AsksForProof(context.http),
              .tokens = [this] { return tokens_.tokens(); },
              .denied = &denied_,
              .first_use = [this](const identity::Caller& caller,
                                  const std::string& from) { NoteFirstUse(caller, from); }}) {
  if (config::SpeaksTls(context.http)) tls_.emplace(FilesOf(context), RulesOf(context.tls));
}

std::vector<transport::CrlFile> AccessSide::ListsNow() {
  std::vector<transport::CrlFile> lists;
  if (!context_.tls.client_crl_file.empty()) {
    lists.push_back({context_.tls.client_crl_file, context_.tls.client_ca_file});
  }
  if (!context_.tls.operator_crl_file.empty()) {
    lists.push_back({context_.tls.operator_crl_file, config::OperatorCaFile(context_.tls)});
  }
  if (context_.identity.authorities.empty()) return lists;
  const auto folder = config::ReadAuthorityFolder(context_.identity.authorities);
  // The listeners say what is wrong with it; what was good last counts, as there.
  if (!folder.ok()) return lists_last_;
  for (const config::AuthorityLists& each : folder->lists) {
    lists.push_back({each.lists, each.authority});
  }
  lists_last_ = lists;
  return lists;
}

absl::Status AccessSide::Open() {
  if (tls_) {
    const transport::FilesLook look = tls_->Refresh();
    if (!look.status.ok()) return look.status;
    expiry_ms_.store(UnixMs(look.served.expiry));
  }
  return LookAtTokens();
}

std::vector<std::string> AccessSide::Look() {
  std::vector<std::string> problems;
  for (const absl::Status& looked : {tls_ ? LookAtTls() : absl::OkStatus(), LookAtTokens()}) {
    if (!looked.ok()) problems.emplace_back(std::string(looked.message()));
  }
  return problems;
}

absl::Status AccessSide::LookAtTokens() {
  absl::Status looked = tokens_.Look();
  context_.probe.tokens.Set(static_cast<std::int64_t>(tokens_.tokens()->table.entries().size()));
  return looked;
}

void AccessSide::NoteFirstUse(const identity::Caller& caller, const std::string& from) {
  context_.audit.Note(admin::RowOf(admin::AskerOf(caller, from),
                                   {.action = admin::kFirstUse,
                                    .target = std::string(identity::ToText(caller.role)),
                                    .detail = caller.note},
                                   absl::OkStatus(), context_.clock.System()));
}

absl::Status AccessSide::LookAtTls() {
  const transport::FilesLook look = tls_->Refresh();
  tls_fits_.store(look.status.ok());
  const std::string before = std::exchange(tls_why_, std::string(look.status.message()));
  if (!look.status.ok()) {
    if (before != tls_why_) {
      context_.logger.Error("http_certificate_mismatch", {{"why", tls_why_}});
    }
    return look.status;
  }
  expiry_ms_.store(UnixMs(look.served.expiry));
  if (before.empty() && look.served == served_) return absl::OkStatus();
  served_ = look.served;
  context_.logger.Info("http_certificate_served",
                       {{"expires", identity::ExpiryText(look.served.expiry)},
                        {"authorities", look.served.authorities},
                        {"certificate_sha256", look.served.certificate_sha256},
                        {"client_ca_sha256", look.served.client_ca_sha256}});
  return absl::OkStatus();
}

health::HttpFacts AccessSide::facts() const {
  health::HttpFacts facts{.certificate_fits = tls_fits_.load(),
                          .tokens_unread = tokens_.unread(),
                          .crl_unread = lists_.unread()};
  if (tls_) facts.certificate_expiry = FromUnixMs(expiry_ms_.load());
  return facts;
}

}  // namespace uplink::run
