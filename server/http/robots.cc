// The handlers of /api/v1 that answer from memory: robots and fleets.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <absl/status/statusor.h>
#include <fmt/core.h>
#include <fmt/format.h>

#include "server/fleet/top_senders.h"
#include "server/http/errors.h"
#include "server/http/handlers.h"
#include "server/http/parameters.h"
#include "server/http/watch_events.h"
#include "server/view/json.h"
#include "server/view/parts.h"
#include "server/view/robots_order.h"
#include "storage/access_store.h"

namespace uplink::http {
namespace {

/// Robots that /api/v1/top names unless it is asked for another number.
constexpr std::uint32_t kTopDefault = 10;
constexpr double kPercentMax = 100;
/// In place of the parts that a list has by default: it adds none.
constexpr std::string_view kNoPart = "none";

std::optional<robot::Presence> ReadPresence(Parameters& parameters) {
  const std::string text = parameters.Text("presence");
  if (text.empty()) return std::nullopt;
  const std::optional<robot::Presence> presence = model::PresenceFromText(text);
  if (presence) return presence;
  parameters.Reject("presence", "must be online, offline or unknown");
  return std::nullopt;
}

view::PartSet ReadParts(Parameters& parameters) {
  const std::vector<std::string> words = parameters.Words("parts");
  if (words.empty()) return view::PartSet::OfLists();
  view::PartSet parts;
  for (const std::string& word : words) {
    if (word == kNoPart) continue;
    const std::optional<view::Part> part = view::PartFromText(word);
    if (part) {
      parts.Add(*part);
    } else {
      parameters.Reject("parts", fmt::format("names no part: {}", word));
    }
  }
  return parts;
}

/// `label=NAME=VALUE`, several times.
std::vector<std::pair<std::string, std::string>> ReadLabels(Parameters& parameters) {
  std::vector<std::pair<std::string, std::string>> labels;
  for (const std::string& text : parameters.Texts("label")) {
    const std::size_t equals = text.find('=');
    if (equals == 0 || equals == std::string::npos) {
      parameters.Reject("label", "must be NAME=VALUE");
    } else if (labels.size() == storage::kLabelsMax) {
      parameters.Reject("label", fmt::format("is given more than {} times", storage::kLabelsMax));
    } else {
      labels.emplace_back(text.substr(0, equals), text.substr(equals + 1));
    }
  }
  return labels;
}

std::optional<double> ReadPercent(Parameters& parameters, std::string_view name) {
  const std::vector<double> numbers = parameters.Decimals(name, 1);
  if (numbers.empty()) return std::nullopt;
  if (numbers[0] < 0 || numbers[0] > kPercentMax) {
    parameters.Reject(name, "must be from 0 to 100");
  }
  return numbers[0];
}

std::optional<view::BoundingBox> ReadBox(Parameters& parameters) {
  constexpr std::size_t kEdges = 4;
  constexpr double kLongitudeMax = 180;
  constexpr double kLatitudeMax = 90;
  const std::vector<double> edges = parameters.Decimals("bbox", kEdges);
  if (edges.empty()) return std::nullopt;
  const view::BoundingBox box{edges[0], edges[1], edges[2], edges[3]};
  const bool is_good = std::abs(box.west) <= kLongitudeMax && std::abs(box.east) <= kLongitudeMax &&
                       box.south >= -kLatitudeMax && box.south <= box.north &&
                       box.north <= kLatitudeMax;
  if (!is_good) parameters.Reject("bbox", "must be west,south,east,north in degrees");
  return box;
}

view::RobotsOrder ReadOrder(Parameters& parameters) {
  const std::string text = parameters.Text("orderBy");
  if (text.empty()) return {};
  const std::optional<view::RobotsOrder> order = view::RobotsOrderFromText(text);
  if (!order) {
    parameters.Reject("orderBy", fmt::format("must be one of {}, with - before it for descending",
                                             fmt::join(view::kRobotsByNames, ", ")));
  }
  return order.value_or(view::RobotsOrder());
}

view::RobotsFilter ReadFilter(Parameters& parameters, const identity::Scope& scope) {
  view::RobotsFilter filter;
  filter.fleets = scope.Restrict(parameters.Text("fleet"));
  filter.q = parameters.Text("q");
  filter.presence = ReadPresence(parameters);
  filter.offline_before = parameters.Time("offlineBefore");
  filter.set.labels = ReadLabels(parameters);
  filter.set.blocked = parameters.MaybeFlag("blocked");
  filter.values.battery_below = ReadPercent(parameters, "batteryBelow");
  filter.values.bbox = ReadBox(parameters);
  filter.values.software = parameters.Text("software");
  filter.values.held_back = parameters.MaybeFlag("heldBack");
  filter.values.estop = parameters.MaybeFlag("estop");
  filter.values.faulted = parameters.MaybeFlag("faulted");
  filter.values.certificate_expires_before = parameters.Time("certificateExpiresBefore");
  return filter;
}

}  // namespace

bool RobotsReadStore(const RoutedRequest& request) {
  Parameters parameters(request.query);
  return ReadParts(parameters).AnyStored();
}

Response GetRobots(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  view::RobotsQuery query;
  query.filter = ReadFilter(parameters, request.caller.scope);
  query.order = ReadOrder(parameters);
  query.parts = ReadParts(parameters);
  query.page_size = ReadPageSize(parameters);
  query.page_token = parameters.TextOrEmpty("pageToken");
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  const absl::StatusOr<view::RobotsPage> page = sources.queries.Robots(query);
  return page.ok() ? JsonResponse(view::Encode(request.form, *page, query.parts))
                   : ErrorResponse(page.status());
}

std::variant<view::WatchQuery, Response> WatchQueryOf(const RoutedRequest& request) {
  Parameters parameters(request.query);
  view::WatchQuery query{.caller = WatcherOf(request.caller)};
  query.filter = ReadFilter(parameters, request.caller.scope);
  query.filter.ruris = parameters.Texts("ruri");
  std::ranges::sort(query.filter.ruris);
  query.parts = ReadParts(parameters);
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  return query;
}

Response GetWatch(const Sources& sources, const RoutedRequest& request) {
  std::variant<view::WatchQuery, Response> query = WatchQueryOf(request);
  if (auto* refusal = std::get_if<Response>(&query)) return std::move(*refusal);
  return WatchResponse(sources.watches, std::get<view::WatchQuery>(std::move(query)));
}

Response GetFleets(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  view::FleetsQuery query;
  query.fleets = request.caller.scope.Restrict(parameters.Text("fleet"));
  query.page_size = ReadPageSize(parameters);
  query.page_token = parameters.TextOrEmpty("pageToken");
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  const absl::StatusOr<view::FleetsPage> page = sources.queries.Fleets(query);
  return page.ok() ? JsonResponse(view::Encode(request.form, *page)) : ErrorResponse(page.status());
}

Response GetTop(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  std::string by = parameters.Text("by");
  if (by.empty()) by = fleet::kTopByNames.front();
  const std::optional<fleet::TopBy> order = fleet::TopByFromText(by);
  if (!order) {
    parameters.Reject("by", fmt::format("must be one of {}", fmt::join(fleet::kTopByNames, ", ")));
  }
  const std::vector<std::string> fleets = request.caller.scope.Restrict(parameters.Text("fleet"));
  const std::uint32_t count = parameters.Number("pageSize", kTopDefault, fleet::kTopMax);
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  return JsonResponse(view::Encode(request.form, sources.queries.Top(*order, count, fleets), by));
}

Response GetCandidates(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  const std::vector<std::string> fleets = request.caller.scope.Restrict(parameters.Text("fleet"));
  const std::uint32_t count =
      parameters.Number("pageSize", storage::kPageSizeDefault, storage::kPageSizeMax);
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  return JsonResponse(view::Encode(request.form, sources.queries.Candidates(count, fleets)));
}

Response GetRobot(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  const std::string ruri = request.segment.empty() ? parameters.Text("ruri") : request.segment;
  if (ruri.empty()) parameters.Reject("ruri", "is missing: name the robot");
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  const absl::StatusOr<view::RobotView> robot =
      sources.queries.Robot(ruri, request.caller.scope.Restrict(""));
  return robot.ok() ? JsonResponse(view::Encode(request.form, *robot, view::PartSet::All()))
                    : ErrorResponse(robot.status());
}

}  // namespace uplink::http
