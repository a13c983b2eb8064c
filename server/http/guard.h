#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "schema/base/clock.h"
#include "server/http/denied.h"
#include "server/http/denied_lines.h"
#include "server/http/message.h"
#include "server/http/probe.h"
#include "server/http/routes.h"
#include "server/http/token_files.h"
#include "server/identity/caller.h"
#include "server/identity/deny_list.h"
#include "server/limits/policies.h"
#include "server/limits/recent_keys.h"
#include "server/limits/recent_times.h"
#include "server/log/logger.h"

namespace uplink::http {

/// Callers whose first request is remembered, so that it is logged once. Past it, the one that
/// asked least recently is logged again.
inline constexpr std::size_t kCallersKnownMax = 2'048;
/// How often the caller of an answer that goes on, such as a watch, is judged again: one whose
/// proof was taken back sees no more after that.
inline constexpr std::chrono::seconds kCallerJudgedEvery{1};

/// Who asks, and whether it may: by the token of a request, else by the certificate of its
/// connection. It counts and logs what it denies.
///
/// Without Options::asks every caller is identity::LocalCaller, unless its request is one of those
/// that always ask (Request::proves). Otherwise every path but the probes
/// needs a proof, on each listener. After kFailedProofsOfSource a source gets 429 in place of 401;
/// good proofs pass all the same.
///
/// Thread: thread-safe; no lock is held while a line is written.
class Guard final {
 public:
  struct Options {
    /// Callers must show who they are.
    bool asks = false;
    /// As they are now, never null; empty: there are none. Where there is one for scrapes,
    /// listen.metrics asks for it, whatever `asks` says, and it opens nothing else.
    std::function<std::shared_ptr<const Tokens>()> tokens{};
    /// Certificates and keys that open nothing, asked at each request. It outlives the guard; null:
    /// none.
    const identity::DenyList* denied = nullptr;
    /// Gets each caller with its first request, and where that came from; may be empty. Any thread,
    /// with no lock held.
    std::function<void(const identity::Caller& caller, const std::string& from)> first_use{};
  };
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    const log::Logger& logger;
    HttpProbe& probe;
  };
  Guard(const Context& context, Options options);
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;

  struct Answer {
    identity::Caller caller{};
    /// It may not ask; or it has not shown who it is.
    std::optional<Response> refusal{};
    /// It has shown who it is, though it may not ask this.
    bool known = false;
  };
  [[nodiscard]] Answer Ask(const Request& request, RouteId route);

  /// A connection was not served, for a reason that shows before its first request.
  void NoteDenied(Denied why, const Source& source, const std::string& from);

 private:
  /// How often a proof may fail, in Policy::per.
  static constexpr std::size_t kFailuresMax =
      limits::PolicyOf(limits::PolicyId::kFailedProofsOfSource).most;
  using Failures = limits::RecentTimes<kFailuresMax>;
  static constexpr std::size_t kFailingSourcesMax =
      limits::PolicyOf(limits::PolicyId::kFailedProofsOfSource).keys_max;

  [[nodiscard]] std::shared_ptr<const Tokens> TokensNow() const;
  [[nodiscard]] Answer ByToken(std::string_view token, const Tokens& tokens, const Request& request,
                               RouteId route);
  [[nodiscard]] Answer ByCertificate(const PeerCertificate& certificate, const Request& request,
                                     RouteId route);
  /// After its proof: whether it has the right.
  [[nodiscard]] Answer Judge(identity::Caller caller, const Request& request, RouteId route);
  /// The answer to who has not shown who it is: `refusal`, or 429.
  /// `name`: whose proof it was, if that is known.
  [[nodiscard]] Answer Fail(Denied why, Response refusal, const Request& request, RouteId route,
                            const std::string& name = {});
  [[nodiscard]] Answer Deny(Denied why, Response refusal, const std::string& name,
                            const Request& request, RouteId route);
  /// Whether the source has failed too often; notes that it failed again, if it has not.
  [[nodiscard]] bool HasFailedTooOften(Denied why, const Source& source);
  void NoteCaller(const identity::Caller& caller, const std::string& from);

  const Context context_;
  const Options options_;
  DeniedLines lines_;
  std::mutex mutex_;
  limits::RecentKeys<Source, Failures, kFailingSourcesMax> failures_;
  limits::RecentKeys<std::string, bool, kCallersKnownMax> callers_;
};

}  // namespace uplink::http
