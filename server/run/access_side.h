#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/admin/audit_trail.h"
#include "server/config/config.h"
#include "server/health/readiness.h"
#include "server/http/guard.h"
#include "server/http/probe.h"
#include "server/http/tls_context.h"
#include "server/http/token_files.h"
#include "server/identity/deny_list.h"
#include "server/identity/served_pems.h"
#include "server/log/logger.h"
#include "server/transport/crl_files.h"

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
    const config::IdentityConfig& identity;
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

  /// Never waits.
  [[nodiscard]] health::HttpFacts facts() const;
  [[nodiscard]] http::Guard& guard() { return guard_; }
  /// What the authorities' lists revoke. Look on one thread.
  [[nodiscard]] transport::CrlFiles& lists() { return lists_; }
  /// Certificates and keys that may not come in, by HTTP or elsewhere.
  [[nodiscard]] identity::DenyList& denied() { return denied_; }
  /// Null: listen.http speaks no TLS.
  [[nodiscard]] const http::ServedTls* tls() const { return tls_ ? &*tls_ : nullptr; }

 private:
  [[nodiscard]] absl::Status LookAtTokens();
  /// The files of lists as the configuration and the folder of authorities name them now.
  [[nodiscard]] std::vector<transport::CrlFile> ListsNow();
  absl::Status LookAtTls();
  void NoteFirstUse(const identity::Caller& caller, const std::string& from);

  const Context context_;
  std::optional<http::ServedTls> tls_;
  http::TokenFiles tokens_;
  /// As of the last look.
  identity::ServedPems served_;
  std::atomic<std::int64_t> expiry_ms_{0};
  /// Why the files of TLS did not fit at the last look.
  std::string tls_why_;
  std::atomic<bool> tls_fits_{true};
  /// What ListsNow found last. Of the thread that looks at them.
  std::vector<transport::CrlFile> lists_last_;
  transport::CrlFiles lists_;
  identity::DenyList denied_;
  http::Guard guard_;
};

}  // namespace uplink::run
