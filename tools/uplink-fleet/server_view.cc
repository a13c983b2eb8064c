#include "tools/uplink-fleet/server_view.h"

#include <utility>

#include <fmt/core.h>
#include <google/protobuf/util/json_util.h>

namespace uplink::synthetic {
namespace {

constexpr int kPageSize = 1000;

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
absl::StatusOr<Message> Fetch(HttpClient& http, const std::string& target) {
  const absl::StatusOr<std::string> json = http.Get(target);
  if (!json.ok()) return json.status();
  return Parse<Message>(target, *json);
}

/// Follows page tokens; `rows` finds the list in a response, `take` gets each row.
template <typename Response, typename Rows, typename Take>
absl::Status FetchPages(HttpClient& http, const std::string& target, Rows rows, Take take) {
  std::string token;
  for (int page = 0; page < kPagesMax; ++page) {
    const char separator = target.find('?') == std::string::npos ? '?' : '&';
    std::string path = fmt::format("{}{}pageSize={}", target, separator, kPageSize);
    if (!token.empty()) path += "&pageToken=" + PercentEncoded(token);
    absl::StatusOr<Response> response = Fetch<Response>(http, path);
    if (!response.ok()) return response.status();
    for (auto& row : *rows(*response)) {
      take(std::move(row));
    }
    token = response->next_page_token();
    if (token.empty()) return absl::OkStatus();
  }
  return absl::InternalError(fmt::format("GET {}: more than {} pages", target, kPagesMax));
}

}  // namespace

absl::StatusOr<v1::ServerStatus> ServerView::Status() {
  return Fetch<v1::ServerStatus>(http_, "/api/v1/status");
}

absl::StatusOr<std::map<std::string, v1::Robot>> ServerView::Robots(const std::string& fleet) {
  std::map<std::string, v1::Robot> robots;
  const absl::Status status = FetchPages<v1::ListRobotsResponse>(
      http_, "/api/v1/robots?parts=motion,status&fleet=" + PercentEncoded(fleet),
      [](auto& response) { return response.mutable_robots(); },
      [&](v1::Robot&& robot) { robots[robot.ruri()] = std::move(robot); });
  if (!status.ok()) return status;
  return robots;
}

absl::StatusOr<StoredRobot> ServerView::Stored(const std::string& ruri) {
  StoredRobot stored;
  const std::string name = PercentEncoded(ruri);
  const auto faults = [](auto& response) { return response.mutable_faults(); };
  const absl::Status all[] = {
      FetchPages<v1::ListFaultsResponse>(
          http_, "/api/v1/faults?ruri=" + name, faults,
          [&](v1::Fault&& row) { stored.faults.push_back(std::move(row)); }),
      FetchPages<v1::ListFaultsResponse>(
          http_, "/api/v1/faults?active=true&ruri=" + name, faults,
          [&](v1::Fault&& row) { stored.active_faults.push_back(std::move(row)); }),
      FetchPages<v1::ListQuarantineResponse>(
          http_, fmt::format("/api/v1/robots/{}/quarantine", name),
          [](auto& response) { return response.mutable_items(); },
          [&](v1::Quarantined&& row) { stored.quarantine.push_back(std::move(row)); }),
      FetchPages<v1::ListGapsResponse>(
          http_, fmt::format("/api/v1/robots/{}/gaps", name),
          [](auto& response) { return response.mutable_gaps(); },
          [&](v1::Gap&& row) { stored.gaps.push_back(std::move(row)); }),
  };
  for (const absl::Status& status : all) {
    if (!status.ok()) return status;
  }
  return stored;
}

}  // namespace uplink::synthetic
