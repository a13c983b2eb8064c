#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include <absl/status/statusor.h>

#include "server/http/message.h"
#include "server/http/parameters.h"

namespace uplink::http {

/// The answer for a failure: kInvalidArgument is 400 (a message that begins with `pageToken` names
/// that field), kNotFound 404, kDeadlineExceeded 504, what is worth a retry 503 UNAVAILABLE,
/// anything else 500. What the store said of itself stays in Response::cause: a client sees a text
/// per kind.
[[nodiscard]] Response ErrorResponse(const absl::Status& status);
[[nodiscard]] Response ErrorResponse(const BadParameter& problem);
/// 404 for a path that is none of ours.
[[nodiscard]] Response NoSuchPath(std::string_view path);
/// The same for a command, by CommandCodeOf (admin/command_code.h): its kInvalidArgument begins
/// with the field.
[[nodiscard]] Response CommandError(const absl::Status& status);
/// 405; the path takes GET and HEAD, or POST if it changes something.
[[nodiscard]] Response MethodNotAllowed(bool changes = false);
/// 415: the body is no JSON.
[[nodiscard]] Response NotJson();
/// 503: too many requests wait already.
[[nodiscard]] Response TooBusy();
/// 503: too many scrapes wait, or too many of their texts are sent.
[[nodiscard]] Response TooManyScrapes();
/// 503: no more watches may begin. `why` names the bound.
[[nodiscard]] Response TooManyWatches(std::string_view why);
/// 503: there is no store yet, and no robot.
[[nodiscard]] Response Starting();
/// 401: who asks must show who it is. `why` is the answer's text.
[[nodiscard]] Response Unauthenticated(std::string_view why);
/// 401: the token that was shown is none of ours, or has expired.
[[nodiscard]] Response InvalidToken(std::string_view why);
/// 403: who asks may not. `why` names what is needed.
[[nodiscard]] Response Forbid(std::string_view why);
/// 429, in place of 401: its source has shown too many wrong proofs.
[[nodiscard]] Response TooManyFailures(std::chrono::seconds retry_after);
/// 400: a token is no part of an address.
[[nodiscard]] Response TokenInAddress();
/// 421: the data are not shown under this name.
[[nodiscard]] Response MisdirectedRequest();
/// 403: a page of another site asks.
[[nodiscard]] Response ForeignPage();
/// 503, and the connection ends: those that are left are for probes and scrapes.
[[nodiscard]] Response TooManyConnections();
/// A request that is not HTTP as we take it: `status` is 400, 413 or 431.
[[nodiscard]] Response BadRequest(int status, std::string_view message);

/// The JSON as an answer, or the answer for what failed.
[[nodiscard]] Response JsonResponse(absl::StatusOr<std::string> json);

}  // namespace uplink::http
