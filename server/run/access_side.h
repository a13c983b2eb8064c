#pragma once

#include <optional>
#include <string>
#include <vector>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/admin/audit_trail.h"
#include "server/config/config.h"
#include "server/http/guard.h"
#include "server/http/probe.h"
#include "server/http/tls_context.h"
#include "server/http/token_files.h"
#include "server/log/logger.h"

namespace uplink::run {

/// Who may come in by HTTP, and ask: the files of tokens and of listen.http's TLS, which may change
/// while the server runs, and the guard that goes by them.
///
/// Thread: Open on main; Look on one. The rest: any.
class AccessSide final {
 public:
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    const log::Logger& logger;
    const config::HttpConfig& http;
    const config::TlsConfig& tls;
    http::HttpProbe& probe;
    admin::AuditTrail& audit;
  };
  explicit AccessSide(const Context& context);
  AccessSide(const AccessSide&) = delete;
  AccessSide& operator=(const AccessSide&) = delete;

  /// Reads the files. Errors: kFailedPrecondition names the file that cannot be used.
  [[nodiscard]] absl::Status Open();
  /// Reads the files again; the last good ones stay where one cannot be used. Each change is a
  /// line. Returns what is wrong with them.
  std::vector<std::string> Look();

  /// Whether a file of tokens on disk is not what is used.
  [[nodiscard]] bool tokens_unread() const { return tokens_.unread(); }
  [[nodiscard]] http::Guard& guard() { return guard_; }
  /// Null: listen.http speaks no TLS.
  [[nodiscard]] const http::ServedTls* tls() const { return tls_ ? &*tls_ : nullptr; }

 private:
  [[nodiscard]] absl::Status LookAtTokens();
  absl::Status LookAtTls();
  void NoteFirstUse(const identity::Caller& caller, const std::string& from);

  const Context context_;
  std::optional<http::ServedTls> tls_;
  http::TokenFiles tokens_;
  std::string certificate_sha256_;
  /// Why the files of TLS did not fit at the last look.
  std::string tls_why_;
  http::Guard guard_;
};

}  // namespace uplink::run
