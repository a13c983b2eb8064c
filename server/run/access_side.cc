#include "server/run/access_side.h"

#include <cstdint>
#include <utility>

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
              .tokens = [this] { return tokens_.tokens(); }}) {
  if (config::SpeaksTls(context.http)) tls_.emplace(FilesOf(context), RulesOf(context.tls));
}

absl::Status AccessSide::Open() {
  if (tls_) {
    const transport::FilesLook look = tls_->Refresh();
    if (!look.status.ok()) return look.status;
    expiry_ms_.store(UnixMs(look.served.expiry));
  }
  return LookAtTokens();
}

void AccessSide::Look() {
  if (tls_) LookAtTls();
  static_cast<void>(LookAtTokens());  // the files have a line of their own
}

absl::Status AccessSide::LookAtTokens() {
  absl::Status looked = tokens_.Look();
  context_.probe.tokens.Set(static_cast<std::int64_t>(tokens_.tokens()->table.entries().size()));
  return looked;
}

void AccessSide::LookAtTls() {
  const transport::FilesLook look = tls_->Refresh();
  tls_fits_.store(look.status.ok());
  const std::string before = std::exchange(tls_why_, std::string(look.status.message()));
  if (!look.status.ok()) {
    if (before != tls_why_) {
      context_.logger.Error("http_certificate_mismatch", {{"why", tls_why_}});
    }
    return;
  }
  expiry_ms_.store(UnixMs(look.served.expiry));
  if (before.empty() && look.served == served_) return;
  served_ = look.served;
  context_.logger.Info("http_certificate_served",
                       {{"expires", identity::ExpiryText(look.served.expiry)},
                        {"authorities", look.served.authorities},
                        {"certificate_sha256", look.served.certificate_sha256},
                        {"client_ca_sha256", look.served.client_ca_sha256}});
}

health::HttpFacts AccessSide::facts() const {
  health::HttpFacts facts{.certificate_fits = tls_fits_.load(), .tokens_unread = tokens_.unread()};
  if (tls_) facts.certificate_expiry = FromUnixMs(expiry_ms_.load());
  return facts;
}

}  // namespace uplink::run
