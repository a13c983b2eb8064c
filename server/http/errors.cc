#include "server/http/errors.h"

#include <string>

#include <fmt/core.h>

#include "server/view/json.h"

namespace uplink::http {
namespace {

struct Kind {
  int status;
  std::string_view code;
};

Kind KindOf(absl::StatusCode code) {
  switch (code) {
    case absl::StatusCode::kInvalidArgument:
      return {400, "INVALID_ARGUMENT"};
    case absl::StatusCode::kNotFound:
      return {404, "NOT_FOUND"};
    case absl::StatusCode::kUnavailable:
    case absl::StatusCode::kAborted:
    case absl::StatusCode::kResourceExhausted:
    case absl::StatusCode::kDeadlineExceeded:
      return {503, "UNAVAILABLE"};
    default:  // a foreign enumeration: every other code is a fault of ours or the store's
      return {500, "INTERNAL"};
  }
}

Response Answer(int status, const view::ErrorText& text) {
  Response response;
  response.status = status;
  response.body = view::ErrorJson(text);
  return response;
}

}  // namespace

Response ErrorResponse(const absl::Status& status) {
  constexpr std::string_view kPageToken = "pageToken";
  const std::string message(status.message());
  const Kind kind = KindOf(status.code());
  const bool token = kind.status == 400 && message.starts_with(kPageToken);
  return Answer(kind.status, {kind.code, message, token ? kPageToken : std::string_view()});
}

Response ErrorResponse(const BadParameter& problem) {
  return Answer(400, {"INVALID_ARGUMENT", fmt::format("{} {}", problem.field, problem.message),
                      problem.field});
}

Response NoSuchPath(std::string_view path) {
  return Answer(404, {"NOT_FOUND", fmt::format("there is nothing at {}", path)});
}

Response MethodNotAllowed() {
  Response response = Answer(405, {"UNIMPLEMENTED", "this path takes GET and HEAD"});
  response.allow = "GET, HEAD";
  return response;
}

Response TooBusy() {
  return Answer(503, {"UNAVAILABLE", "too many requests wait for the store; try again"});
}

Response Starting() { return Answer(503, {"UNAVAILABLE", "the server starts; try again"}); }

Response MisdirectedRequest() {
  return Answer(421, {"INVALID_ARGUMENT",
                      "the host of this request is neither an address nor localhost, and not one "
                      "of http.hosts"});
}

Response TooManyConnections() {
  Response response = Answer(503, {"UNAVAILABLE", "too many connections; try again"});
  response.closes = true;
  return response;
}

Response BadRequest(int status, std::string_view message) {
  return Answer(status, {"INVALID_ARGUMENT", message});
}

}  // namespace uplink::http
