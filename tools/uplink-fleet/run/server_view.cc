#include "tools/uplink-fleet/run/server_view.h"

#include <utility>

#include <fmt/core.h>
#include <google/protobuf/util/json_util.h>

#include "schema/base/rfc3339.h"
#include "server/view/timestamps.h"
#include "storage/live_parts.h"

namespace uplink::synthetic {
namespace {

constexpr int kPageSize = 1000;
/// Every part: the live ones, then those whose latest message the store keeps.
constexpr const char* kParts =
#define UPLINK_PART(Part, column, view, Message, keys_max) view ","
    UPLINK_LIVE_PARTS(UPLINK_PART)
#undef UPLINK_PART
        "agentInfo,settings,uiCapabilities";

/// A time as a parameter.
std::string TimeOf(std::int64_t unix_ms) {
  return link::PercentEncoded(Rfc3339(FromUnixMs(unix_ms)));
}

template <typename Message>
absl::StatusOr<Message> Parse(const std::string& target, const std::string& json) {
  google::protobuf::util::JsonParseOptions options;
  options.ignore_unknown_fields = true;  // a newer server may say more
  Message message;
  const auto status = google::protobuf::util::JsonStringToMessage(json, &message, options);
  if (!status.ok()) {
    return absl::InternalError(
        fmt::format("GET {}: not the contract's JSON: {}", target, status.ToString()));
  }
  return message;
}

template <typename Message>
absl::StatusOr<Message> Fetch(link::HttpClient& http, const std::string& target) {
  const absl::StatusOr<std::string> json = http.Get(target);
  if (!json.ok()) return json.status();
  return Parse<Message>(target, *json);
}

/// Follows page tokens; `rows` finds the list in a response, `take` gets each row.
template <typename Response, typename Rows, typename Take>
absl::Status FetchPages(link::HttpClient& http, const std::string& target, Rows rows, Take take) {
  std::string token;
  for (int page = 0; page < kPagesMax; ++page) {
    const char separator = target.find('?') == std::string::npos ? '?' : '&';
    std::string path = fmt::format("{}{}pageSize={}", target, separator, kPageSize);
    if (!token.empty()) path += "&pageToken=" + link::PercentEncoded(token);
    absl::StatusOr<Response> response = Fetch<Response>(http, path);
    if (!response.ok()) return response.status();
    auto& received = *rows(*response);
    for (auto& row : received) {
      take(std::move(row));
    }
    token = response->next_page_token();
    if (token.empty()) return absl::OkStatus();
  }
  return absl::InternalError(fmt::format("GET {}: more than {} pages", target, kPagesMax));
}

}  // namespace

absl::StatusOr<v1::ServerStatus> ServerView::Status() {
  const std::int64_t before_ms = UnixMs(clock_.System());
  absl::StatusOr<v1::ServerStatus> status = Fetch<v1::ServerStatus>(http_, "/api/v1/status");
  if (!status.ok()) return status;
  ahead_min_ms_ = view::UnixMs(status->now()) - UnixMs(clock_.System());
  ahead_max_ms_ = view::UnixMs(status->now()) - before_ms;
  return status;
}

Span ServerView::Now() const {
  const std::int64_t now_ms = UnixMs(clock_.System());
  return {now_ms + ahead_min_ms_, now_ms + ahead_max_ms_};
}

absl::StatusOr<std::map<std::string, v1::Robot>> ServerView::Robots(const std::string& fleet) {
  std::map<std::string, v1::Robot> robots;
  const absl::Status status = FetchPages<v1::ListRobotsResponse>(
      http_, fmt::format("/api/v1/robots?parts={}&fleet={}", kParts, link::PercentEncoded(fleet)),
      [](auto& response) { return response.mutable_robots(); },
      [&](v1::Robot&& robot) { robots[robot.ruri()] = std::move(robot); });
  if (!status.ok()) return status;
  return robots;
}

absl::StatusOr<SharedItems> ServerView::Shared(const std::string& fleet) {
  std::vector<v1::Shape> shapes;
  std::vector<v1::TrackedObject> objects;
  const std::string name = link::PercentEncoded(fleet);
  absl::Status status = FetchPages<v1::ListShapesResponse>(
      http_, "/api/v1/shapes?fleet=" + name, [](auto& page) { return page.mutable_shapes(); },
      [&shapes](v1::Shape&& row) { shapes.push_back(std::move(row)); });
  if (!status.ok()) return status;
  status = FetchPages<v1::ListObjectsResponse>(
      http_, "/api/v1/objects?fleet=" + name, [](auto& page) { return page.mutable_objects(); },
      [&objects](v1::TrackedObject&& row) { objects.push_back(std::move(row)); });
  if (!status.ok()) return status;
  return SharedOf(shapes, objects);
}

absl::StatusOr<StoredRobot> ServerView::Stored(const std::string& ruri, std::int64_t from_ms) {
  StoredRobot stored;
  const std::string name = link::PercentEncoded(ruri);
  const std::string from = TimeOf(from_ms);
  const auto list = [&](const char* path) { return fmt::format("/api/v1/{}?ruri={}", path, name); };
  const auto history = [&](const char* path) {
    return fmt::format("{}&from={}", list(path), from);
  };
  const auto into = [](auto& rows) {
    return [&rows]<typename Row>(Row&& row) { rows.push_back(std::forward<Row>(row)); };
  };
  stored.read.from_ms = Now().from_ms;
  const absl::Status present[] = {
      FetchPages<v1::ListShapesResponse>(
          http_, list("shapes"), [](auto& page) { return page.mutable_shapes(); },
          into(stored.shapes)),
      FetchPages<v1::ListObjectsResponse>(
          http_, list("objects"), [](auto& page) { return page.mutable_objects(); },
          into(stored.objects))};
  stored.read.to_ms = Now().to_ms;
  const auto faults = [](auto& page) { return page.mutable_faults(); };
  const absl::Status rest[] = {
      FetchPages<v1::ListFaultsResponse>(http_, history("faults"), faults, into(stored.faults)),
      FetchPages<v1::ListFaultsResponse>(http_, list("faults") + "&active=true", faults,
                                         into(stored.active_faults)),
      FetchPages<v1::ListMissionsResponse>(
          http_, list("missions"), [](auto& page) { return page.mutable_missions(); },
          into(stored.runs)),
      FetchPages<v1::ListEventsResponse>(
          http_, history("events"), [](auto& page) { return page.mutable_events(); },
          into(stored.events)),
      FetchPages<v1::ListMessagesResponse>(
          http_, history("messages"), [](auto& page) { return page.mutable_messages(); },
          into(stored.messages)),
      FetchPages<v1::ListPresenceChangesResponse>(
          http_, list("presence"), [](auto& page) { return page.mutable_presence_changes(); },
          into(stored.presence)),
      FetchPages<v1::ListQuarantineResponse>(
          http_, history("quarantine"),
          [&stored](auto& page) {
            stored.quarantine_dropped = 0;
            for (const auto& [reason, rows] : page.dropped_by_reason()) {
              stored.quarantine_dropped += rows;
            }
            return page.mutable_quarantined();
          },
          into(stored.quarantine)),
      FetchPages<v1::ListGapsResponse>(
          http_, history("gaps"), [](auto& page) { return page.mutable_gaps(); },
          into(stored.gaps))};
  for (const absl::Status& status : present) {
    if (!status.ok()) return status;
  }
  for (const absl::Status& status : rest) {
    if (!status.ok()) return status;
  }
  return stored;
}

absl::StatusOr<std::string> ServerView::RobotText(const std::string& ruri) {
  absl::StatusOr<std::string> text = http_.Get("/api/v1/robot?ruri=" + link::PercentEncoded(ruri));
  if (absl::IsNotFound(text.status())) return std::string();
  return text;
}

absl::StatusOr<std::vector<v1::ScopeUpdate>> ServerView::ScopeUpdates(const std::string& scope,
                                                                      const std::string& id,
                                                                      std::int64_t from_ms) {
  std::vector<v1::ScopeUpdate> updates;
  const absl::Status status = FetchPages<v1::ListScopeUpdatesResponse>(
      http_,
      fmt::format("/api/v1/scope-updates?scope={}&id={}&from={}", scope, id, TimeOf(from_ms)),
      [](auto& page) { return page.mutable_scope_updates(); },
      [&updates](v1::ScopeUpdate&& row) { updates.push_back(std::move(row)); });
  if (!status.ok()) return status;
  return updates;
}

absl::StatusOr<std::vector<v1::OperatorRequest>> ServerView::OperatorRequests(
    const std::string& ruri) {
  std::vector<v1::OperatorRequest> requests;
  const absl::Status status = FetchPages<v1::ListOperatorRequestsResponse>(
      http_, "/api/v1/operator-requests?ruri=" + link::PercentEncoded(ruri),
      [](auto& page) { return page.mutable_operator_requests(); },
      [&requests](v1::OperatorRequest&& row) { requests.push_back(std::move(row)); });
  if (!status.ok()) return status;
  return requests;
}

absl::StatusOr<std::vector<v1::Quarantined>> ServerView::QuarantineOfNoRobot(std::int64_t from_ms) {
  std::vector<v1::Quarantined> rows;
  const absl::Status status = FetchPages<v1::ListQuarantineResponse>(
      http_, fmt::format("/api/v1/quarantine?source=cyberwave&from={}", TimeOf(from_ms)),
      [](auto& page) { return page.mutable_quarantined(); },
      [&rows](v1::Quarantined&& row) {
        if (row.ruri().empty()) rows.push_back(std::move(row));
      });
  if (!status.ok()) return status;
  return rows;
}

}  // namespace uplink::synthetic
