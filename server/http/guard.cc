#include "server/http/guard.h"

#include <utility>

#include <fmt/core.h>
#include <openssl/crypto.h>

#include "server/http/errors.h"
#include "server/http/rights.h"
#include "server/identity/fleet_name.h"

namespace uplink::http {
namespace {

using identity::Role;
using identity::Scope;
using identity::TokenTable;

constexpr std::chrono::seconds kFailureSpan =
    limits::PolicyOf(limits::PolicyId::kFailedProofsOfSource).per;
/// What logs call the holder of http.metrics_token_file.
constexpr std::string_view kScrapeTokenName = "metrics_token_file";

bool IsKnown(RouteId route) { return route.index < Routes().size(); }

std::string_view TextOf(identity::Proof proof) {
  switch (proof) {
    case identity::Proof::kNone:
      return "none";
    case identity::Proof::kToken:
      return "token";
    case identity::Proof::kCertificate:
      return "certificate";
  }
  return "";
}

Scope ScopeOf(const std::string& fleet) {
  if (fleet == identity::kAllFleets) return Scope::All();
  return Scope::Of({fleet});
}

/// Its time tells nothing of how much of the token is right.
bool IsToken(const std::optional<identity::TokenHash>& hash, std::string_view token) {
  if (!hash) return false;
  const identity::TokenHash shown = identity::HashOfToken(token);
  return CRYPTO_memcmp(shown.data(), hash->data(), shown.size()) == 0;
}

bool MayAsk(const identity::PeerIdentity& peer) {
  return peer.role != Role::kRobot && peer.role != Role::kGateway;
}

}  // namespace

Guard::Guard(const Context& context, Options options)
    : context_(context), options_(std::move(options)), lines_(context.logger) {}

std::shared_ptr<const Tokens> Guard::TokensNow() const {
  return options_.tokens ? options_.tokens() : std::make_shared<const Tokens>();
}

Guard::Answer Guard::Ask(const Request& request, RouteId route) {
  const std::shared_ptr<const Tokens> tokens = TokensNow();
  const bool scrapes_ask = request.listener == ListenerId::kMetrics && tokens->scrape;
  if (!options_.asks && !scrapes_ask && !request.proves) return {.caller = identity::LocalCaller()};
  if (IsKnown(route) && Routes()[route.index].needs.right == Right::kAnyone) return {};
  if (request.authorization) {
    if (const auto token = BearerToken(*request.authorization)) {
      return ByToken(*token, *tokens, request, route);
    }
  }
  if (request.certificate != nullptr) return ByCertificate(*request.certificate, request, route);
  return Fail(Denied::kNoProof,
              Unauthenticated("show who you are: send a token in the header Authorization: Bearer, "
                              "or an operator's certificate"),
              request, route);
}

Guard::Answer Guard::ByToken(std::string_view token, const Tokens& tokens, const Request& request,
                             RouteId route) {
  if (request.listener == ListenerId::kMetrics && IsToken(tokens.scrape, token)) {
    return Judge({.role = Role::kMetrics,
                  .scope = Scope::All(),
                  .proof = identity::Proof::kToken,
                  .name = std::string(kScrapeTokenName)},
                 request, route);
  }
  const TokenTable::Found found = tokens.table.Find(token, context_.clock.System());
  switch (found.finding) {
    case TokenTable::Finding::kValid:
      return Judge({.role = found.entry->role,
                    .scope = found.entry->scope,
                    .proof = identity::Proof::kToken,
                    .name = found.entry->id,
                    .note = found.entry->note},
                   request, route);
    case TokenTable::Finding::kExpired:
      return Fail(Denied::kExpiredToken, InvalidToken("the token has expired"), request, route,
                  found.entry->id);
    case TokenTable::Finding::kUnknown:
      break;
  }
  return Fail(Denied::kBadToken, InvalidToken("the token is not one of this server"), request,
              route);
}

Guard::Answer Guard::ByCertificate(const PeerCertificate& certificate, const Request& request,
                                   RouteId route) {
  if (!certificate.identity.ok()) {
    return Fail(Denied::kBadCertificate,
                Unauthenticated(std::string(certificate.identity.status().message())), request,
                route);
  }
  if (certificate.expiry <= context_.clock.System()) {
    return Fail(Denied::kBadCertificate,
                Unauthenticated("client certificate: it, or one that signed it, has expired"),
                request, route);
  }
  if (options_.denied != nullptr && identity::Denies(*options_.denied->Get(), certificate.chain)) {
    return Fail(Denied::kBadCertificate, Unauthenticated("certificate revoked"), request, route);
  }
  const identity::PeerIdentity& peer = *certificate.identity;
  if (!MayAsk(peer)) {
    const std::string why =
        IsKnown(route) ? WhyForbidden(Routes()[route.index], peer.role, certificate.subject).text
                       : "certificates of robots and gateways open nothing here";
    return Deny(Denied::kRole, Forbid(why), certificate.subject, request, route);
  }
  return Judge({.role = peer.role,
                .scope = ScopeOf(peer.fleet),
                .proof = identity::Proof::kCertificate,
                .name = certificate.subject},
               request, route);
}

Guard::Answer Guard::Judge(identity::Caller caller, const Request& request, RouteId route) {
  // It speaks no TLS: rights beyond its own cross the network readable.
  if (request.listener == ListenerId::kMetrics && caller.role != Role::kMetrics) {
    return Deny(Denied::kRole,
                Forbid(fmt::format("listen.metrics takes callers of the role metrics alone; {} has "
                                   "the role {}",
                                   caller.name, identity::ToText(caller.role))),
                caller.name, request, route);
  }
  NoteCaller(caller, request.from);
  if (IsKnown(route)) {
    if (const auto forbidden = WhyForbidden(Routes()[route.index], caller)) {
      Answer answer = Deny(forbidden->why, Forbid(forbidden->text), caller.name, request, route);
      answer.caller = std::move(caller);
      answer.known = true;
      return answer;
    }
  }
  return {.caller = std::move(caller)};
}

Guard::Answer Guard::Fail(Denied why, Response refusal, const Request& request, RouteId route,
                          const std::string& name) {
  if (HasFailedTooOften(why, request.source)) {
    return Deny(Denied::kTooMany, TooManyFailures(kFailureSpan), {}, request, route);
  }
  return Deny(why, std::move(refusal), name, request, route);
}

Guard::Answer Guard::Deny(Denied why, Response refusal, const std::string& name,
                          const Request& request, RouteId route) {
  context_.probe.denied[static_cast<std::size_t>(why)].Add();
  lines_.Write({.why = why, .route = RouteName(route), .name = name, .from = request.from},
               request.source, context_.clock.Steady());
  return {.refusal = std::move(refusal)};
}

void Guard::NoteDenied(Denied why, const Source& source, const std::string& from) {
  context_.probe.denied[static_cast<std::size_t>(why)].Add();
  lines_.Write({.why = why, .from = from}, source, context_.clock.Steady());
}

bool Guard::HasFailedTooOften(Denied why, const Source& source) {
  const SteadyTime now = context_.clock.Steady();
  const std::lock_guard lock(mutex_);
  // Who shows nothing guesses nothing.
  if (why == Denied::kNoProof) {
    const Failures* const failures = failures_.Find(source);
    return failures != nullptr && failures->IsFull(now, kFailureSpan);
  }
  return !failures_.Touch(source).Take(now, kFailureSpan);
}

void Guard::NoteCaller(const identity::Caller& caller, const std::string& from) {
  const std::string_view proof = TextOf(caller.proof);
  {
    const std::lock_guard lock(mutex_);
    bool& known = callers_.Touch(std::string(proof) + ' ' + caller.name);
    if (std::exchange(known, true)) return;
  }
  context_.logger.Info("http_caller", {{"name", caller.name},
                                       {"role", identity::ToText(caller.role)},
                                       {"proof", proof},
                                       {"from", from}});
  if (options_.first_use) options_.first_use(caller, from);
}

}  // namespace uplink::http
