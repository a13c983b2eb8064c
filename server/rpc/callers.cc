#include "server/rpc/callers.h"

#include <array>
#include <cstddef>
#include <memory>
#include <utility>

#include "schema/base/check.h"
#include "server/http/credentials.h"
#include "server/http/source.h"

namespace uplink::rpc {
namespace {

constexpr std::array<std::pair<std::string_view, absl::StatusCode>, 10> kCodes{{
    {"INVALID_ARGUMENT", absl::StatusCode::kInvalidArgument},
    {"NOT_FOUND", absl::StatusCode::kNotFound},
    {"DEADLINE_EXCEEDED", absl::StatusCode::kDeadlineExceeded},
    {"UNAVAILABLE", absl::StatusCode::kUnavailable},
    {"UNAUTHENTICATED", absl::StatusCode::kUnauthenticated},
    {"PERMISSION_DENIED", absl::StatusCode::kPermissionDenied},
    {"RESOURCE_EXHAUSTED", absl::StatusCode::kResourceExhausted},
    {"FAILED_PRECONDITION", absl::StatusCode::kFailedPrecondition},
    {"UNIMPLEMENTED", absl::StatusCode::kUnimplemented},
    {"INTERNAL", absl::StatusCode::kInternal},
}};

}  // namespace

http::RouteId RouteOf(std::string_view path) {
  for (std::size_t i = 0; i < http::Routes().size(); ++i) {
    if (http::Routes()[i].pattern == path) return {i};
  }
  UPLINK_CHECK(false, "a method names a path of HTTP");
  return http::OtherRoute();
}

absl::Status StatusOf(const http::Response& answer) {
  if (answer.code.empty()) return absl::OkStatus();
  for (const auto& [name, code] : kCodes) {
    if (name == answer.code) return {code, answer.why};
  }
  return absl::InternalError(answer.why);
}

std::string WithoutPort(std::string_view address) {
  if (address.starts_with('[')) return std::string(address.substr(1, address.find(']') - 1));
  return std::string(address.substr(0, address.rfind(':')));
}

absl::StatusOr<identity::Caller> CallerOf(http::Guard& guard, const http::Site* site,
                                          http::RouteId route,
                                          const transport::CallerProof& proof) {
  http::Request request;
  if (!proof.authorization.empty()) request.authorization = proof.authorization;
  if (proof.identity) {
    request.certificate = std::make_shared<const http::PeerCertificate>(http::PeerCertificate{
        .identity = *proof.identity, .subject = proof.subject, .expiry = proof.expiry});
  }
  request.source = http::SourceOf(proof.source);
  request.from = WithoutPort(proof.from);
  request.proves = true;
  http::Guard::Answer answer = guard.Ask(request, route);
  if (answer.refusal) {
    request.caller = std::move(answer.caller);
    if (answer.known && site != nullptr) site->NoteForbidden(request, route);
    return StatusOf(*answer.refusal);
  }
  return std::move(answer.caller);
}

}  // namespace uplink::rpc
