#include "tools/uplinkctl/ask/api.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "schema/base/utf8.h"
#include "schema/json/exact.h"
#include "tools/uplinkctl/ask/server_choice.h"

namespace uplink::ctl {
namespace {

namespace json = boost::json;

/// Bytes of a foreign body that are repeated.
constexpr std::size_t kShownMax = 200;

/// How the server begins to say that it has no such path.
constexpr std::string_view kNothingAt = "there is nothing at ";

constexpr unsigned kOk = 200;
constexpr unsigned kBadRequest = 400;
constexpr unsigned kUnauthorized = 401;
constexpr unsigned kForbidden = 403;
constexpr unsigned kNotFound = 404;
constexpr unsigned kWrongMethod = 405;
constexpr unsigned kAtABound = 409;
constexpr unsigned kTooManyBytes = 413;
constexpr unsigned kTooManyRequests = 429;
constexpr unsigned kUnavailable = 503;
constexpr unsigned kTooLong = 504;

/// The server's sentence; nothing if the body is not one of its errors.
std::optional<std::string> MessageOf(const std::string& body) {
  const std::optional<json::value> value = uplink::json::ParseExact(body);
  const auto* object = value ? value->if_object() : nullptr;
  const auto* error = object == nullptr ? nullptr : object->if_contains("error");
  if (error == nullptr || !error->is_object()) return std::nullopt;
  const auto* message = error->get_object().if_contains("message");
  if (message == nullptr || !message->is_string()) return std::nullopt;
  return std::string(message->get_string().data(), message->get_string().size());
}

std::string AgainIn(const link::HttpAnswer& answer) {
  if (answer.retry_after.empty()) return "try again";
  return "try again in " + PrintableUtf8(answer.retry_after, kShownMax) + " s";
}

/// How the server ends to say that commands come too fast.
constexpr std::string_view kAtOnce = " at once";

/// How long a server asks to wait that has not done a command because it came too fast; nothing: it
/// did something else, or asks for too much.
std::optional<std::chrono::seconds> WaitOf(const absl::StatusOr<link::HttpAnswer>& answer) {
  if (!answer.ok() || answer->status != kTooManyRequests) return std::nullopt;
  const std::string& text = answer->retry_after;
  std::uint32_t seconds = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  const std::chrono::seconds wait(seconds);
  return wait <= kRetryAfterMax ? std::optional(wait) : std::nullopt;
}

/// Takes the rows out of a page. False if the page has no such list.
bool MoveRows(json::object& page, const std::string& member, json::array& into) {
  auto* rows = page.if_contains(member);
  if (rows == nullptr || !rows->is_array()) return false;
  json::array& from = rows->get_array();
  into.insert(into.end(), std::make_move_iterator(from.begin()),
              std::make_move_iterator(from.end()));
  page.erase(member);
  return true;
}

/// Takes the token of the next page out of a page.
std::string TakeToken(json::object& page) {
  const auto* token = page.if_contains("nextPageToken");
  std::string text;
  if (token != nullptr && token->is_string()) {
    text.assign(token->get_string().data(), token->get_string().size());
  }
  page.erase("nextPageToken");
  return text;
}

}  // namespace

std::string PathWith(const std::string& path, const Query& query) {
  std::string target = path;
  for (const auto& [name, value] : query) {
    target += target.size() == path.size() ? '?' : '&';
    target += name + "=" + link::PercentEncoded(value);
  }
  return target;
}

absl::Status Api::ErrorOf(const std::string& path, const link::HttpAnswer& answer) const {
  const std::optional<std::string> message = MessageOf(answer.body);
  if (!message) {
    return absl::InternalError(
        fmt::format("{}: the server answers {}, and not as uplinkd does: {}; the address is {}",
                    path, answer.status, PrintableUtf8(answer.body, kShownMax), source_));
  }
  switch (answer.status) {
    case kBadRequest:
    case kTooManyBytes:
      return absl::InvalidArgumentError(*message);
    case kUnauthorized:
      return absl::UnauthenticatedError(fmt::format(
          "{}; show a token by --token-file FILE, {} or uplinkctl contexts set NAME --token-file "
          "FILE, or a certificate by --certificate-file and --key-file. On the server uplinkctl "
          "tokens new makes a token",
          *message, kTokenVariable));
    case kForbidden:
      return absl::PermissionDeniedError(
          fmt::format("{}; on the server uplinkctl tokens list shows roles and fleets", *message));
    case kWrongMethod:
      return absl::UnimplementedError(*message + "; is the server older than this uplinkctl?");
    case kAtABound:
      return absl::ResourceExhaustedError(*message);
    case kTooManyRequests:
      if (message->ends_with(kAtOnce)) {
        return absl::ResourceExhaustedError(fmt::format("{}; {}", *message, AgainIn(answer)));
      }
      return absl::ResourceExhaustedError(
          fmt::format("{}; {}, and check the file of the token or certificate first", *message,
                      AgainIn(answer)));
    case kNotFound:
      // No row is missing then, but the path.
      return absl::NotFoundError(
          message->starts_with(kNothingAt)
              ? *message + "; is the server older than this uplinkctl, or behind another path?"
              : *message);
    case kUnavailable:
      return absl::UnavailableError(
          fmt::format("{}; {}, and see uplinkctl health --ready", *message, AgainIn(answer)));
    case kTooLong:
      return absl::DeadlineExceededError(
          fmt::format("{}; ask for less: --since, --robot, a lower --limit", *message));
    default:
      return absl::InternalError(fmt::format("{}: {}: {}", path, answer.status, *message));
  }
}

absl::StatusOr<json::object> Api::Get(const std::string& path, const Query& query) {
  return ObjectOf(path, ask_(PathWith(prefix_ + path, query)));
}

absl::StatusOr<json::object> Api::Post(const std::string& path, const json::object& body) {
  const std::string text = json::serialize(body);
  absl::StatusOr<link::HttpAnswer> answer = send_(prefix_ + path, text);
  for (int tries = 1; wait_ && tries < kCommandTriesMax; ++tries) {
    const std::optional<std::chrono::seconds> wait = WaitOf(answer);
    if (!wait) break;
    wait_(*wait);
    answer = send_(prefix_ + path, text);
  }
  return ObjectOf(path, std::move(answer));
}

absl::StatusOr<json::object> Api::ObjectOf(const std::string& path,
                                           absl::StatusOr<link::HttpAnswer> answer) const {
  if (absl::IsUnauthenticated(answer.status())) {
    return absl::UnauthenticatedError(
        fmt::format("{}; the address is {}. --ca-file FILE names the authorities of that server",
                    std::string(answer.status().message()), source_));
  }
  if (!answer.ok()) {
    return absl::UnavailableError(
        fmt::format("{}; the address is {}. Does uplinkd run there? --server URL or uplinkctl "
                    "contexts use NAME chooses another",
                    std::string(answer.status().message()), source_));
  }
  if (answer->status != kOk) return ErrorOf(path, *answer);
  std::optional<json::value> value = uplink::json::ParseExact(answer->body);
  if (!value || !value->is_object()) return ErrorOf(path, *answer);
  return std::move(value->get_object());
}

absl::StatusOr<Rows> Api::List(const std::string& path, const std::string& member,
                               const Query& query, std::size_t limit) {
  Rows rows;
  std::string token;
  do {
    Query page_query = query;
    const std::size_t wanted = std::min(limit - rows.rows.size(), kPageRowsMax);
    page_query.emplace_back("pageSize", fmt::format("{}", wanted));
    if (!token.empty()) page_query.emplace_back("pageToken", token);
    absl::StatusOr<json::object> page = Get(path, page_query);
    if (!page.ok()) return page.status();
    if (!MoveRows(*page, member, rows.rows)) {
      return absl::InternalError(fmt::format("{}: the answer has no {}", path, member));
    }
    token = TakeToken(*page);
    rows.beside = *std::move(page);
  } while (!token.empty() && rows.rows.size() < limit);
  rows.more = !token.empty();
  return rows;
}

}  // namespace uplink::ctl
