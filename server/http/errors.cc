#include "server/http/errors.h"

#include <optional>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "server/admin/command_code.h"
#include "server/admin/command_rate.h"
#include "server/view/error_json.h"

namespace uplink::http {
namespace {

constexpr std::string_view kPageToken = "pageToken";

struct Kind {
  int status;
  std::string_view code;
  /// What the client sees; empty: the status's own message, which is ours.
  std::string_view text;
};

/// What names a parameter comes from us; else it is the store's word on a value.
bool NamesParameter(std::string_view message) {
  return message.starts_with(kPageToken) || message.starts_with("pageSize");
}

Kind KindOf(absl::StatusCode code, std::string_view message) {
  switch (code) {
    case absl::StatusCode::kInvalidArgument:
      return {400, "INVALID_ARGUMENT",
              NamesParameter(message) ? "" : "the store cannot look for such a text"};
    case absl::StatusCode::kNotFound:
      return {404, "NOT_FOUND", ""};
    case absl::StatusCode::kDeadlineExceeded:
      return {504, "DEADLINE_EXCEEDED",
              "the read reached its limit (on PostgreSQL store.timeout, and 5 s at most); ask for "
              "less, or try again"};
    case absl::StatusCode::kUnavailable:
    case absl::StatusCode::kAborted:
    case absl::StatusCode::kResourceExhausted:
      return {503, "UNAVAILABLE", "the store cannot be asked now; try again"};
    default:  // a foreign enumeration: every other code is a fault of ours or the store's
      return {500, "INTERNAL", "the server or its store failed; its log says how"};
  }
}

Response Answer(int status, const view::ErrorText& text) {
  Response response;
  response.status = status;
  response.body = view::ErrorJson(text);
  response.code = text.code;
  response.why = text.message;
  return response;
}

}  // namespace

Response ErrorResponse(const absl::Status& status) {
  const std::string message(status.message());
  const Kind kind = KindOf(status.code(), message);
  if (kind.text.empty()) {
    const bool token = message.starts_with(kPageToken);
    return Answer(kind.status, {kind.code, message, token ? kPageToken : std::string_view()});
  }
  Response response = Answer(kind.status, {kind.code, kind.text});
  response.cause = message.empty() ? std::string(kind.code) : message;
  return response;
}

Response ErrorResponse(const BadParameter& problem) {
  return Answer(400, {"INVALID_ARGUMENT", fmt::format("{} {}", problem.field, problem.message),
                      problem.field});
}

Response NoSuchPath(std::string_view path) {
  return Answer(404, {"NOT_FOUND", fmt::format("there is nothing at {}", path)});
}

Response CommandError(const absl::Status& status) {
  const std::optional<admin::CommandCode> code = admin::CommandCodeOf(status);
  if (!code) return ErrorResponse(status);
  const std::string message(status.message());
  view::ErrorText text{code->name, message};
  if (absl::IsInvalidArgument(status)) text.field = text.message.substr(0, message.find(' '));
  Response response = Answer(code->http, text);
  if (const auto seconds = admin::RetryAfterOf(status)) response.retry_after = *seconds;
  return response;
}

Response MethodNotAllowed(bool changes) {
  Response response = Answer(
      405, {"UNIMPLEMENTED", changes ? "this path takes POST" : "this path takes GET and HEAD"});
  response.allow = changes ? "POST" : "GET, HEAD";
  return response;
}

Response NotJson() {
  return Answer(
      415, {"INVALID_ARGUMENT", "a command has Content-Type: application/json, also without a body",
            "Content-Type"});
}

Response TooBusy() {
  return Answer(503, {"UNAVAILABLE", "too many requests wait for the store; try again"});
}

Response TooManyScrapes() {
  return Answer(503, {"UNAVAILABLE", "too many scrapes are under way; try again"});
}

Response TooManyWatches(std::string_view why) { return Answer(503, {"UNAVAILABLE", why}); }

Response Starting() { return Answer(503, {"UNAVAILABLE", "the server starts; try again"}); }

Response Unauthenticated(std::string_view why) {
  Response response = Answer(401, {"UNAUTHENTICATED", why});
  response.authenticate = "Bearer";
  return response;
}

Response InvalidToken(std::string_view why) {
  Response response = Unauthenticated(why);
  response.authenticate = R"(Bearer error="invalid_token")";
  return response;
}

Response Forbid(std::string_view why) { return Answer(403, {"PERMISSION_DENIED", why}); }

Response TooManyFailures(std::chrono::seconds retry_after) {
  Response response = Answer(429, {"RESOURCE_EXHAUSTED",
                                   "too many wrong tokens or certificates came from this address; "
                                   "try again later, with a good one at any time"});
  response.retry_after = retry_after;
  return response;
}

Response TokenInAddress() {
  return Answer(400, {"INVALID_ARGUMENT",
                      "a token stands in the address, which logs and proxies keep: revoke it, and "
                      "send tokens in the header Authorization: Bearer"});
}

Response MisdirectedRequest() {
  return Answer(421, {"INVALID_ARGUMENT",
                      "the host of this request is neither an address nor localhost, and not one "
                      "of http.hosts"});
}

Response ForeignPage() {
  return Answer(403,
                {"PERMISSION_DENIED",
                 "a page of another site asks: so says Sec-Fetch-Site, or its Origin, which is "
                 "neither this host nor one of http.hosts"});
}

Response TooManyConnections() {
  Response response = Answer(503, {"UNAVAILABLE", "too many connections; try again"});
  response.closes = true;
  return response;
}

Response BadRequest(int status, std::string_view message) {
  return Answer(status, {"INVALID_ARGUMENT", message});
}

Response JsonResponse(absl::StatusOr<std::string> json) {
  if (!json.ok()) return ErrorResponse(json.status());
  Response response;
  response.body = *std::move(json);
  return response;
}

}  // namespace uplink::http
