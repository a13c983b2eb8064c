// The handlers of /api/v1 that answer from memory.
#include <optional>
#include <string>
#include <vector>

#include <absl/status/statusor.h>
#include <fmt/core.h>

#include "server/http/errors.h"
#include "server/http/handlers.h"
#include "server/http/parameters.h"
#include "server/view/json.h"
#include "server/view/parts.h"

namespace uplink::http {
namespace {

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
    const std::optional<view::Part> part = view::PartFromText(word);
    if (part) {
      parts.Add(*part);
    } else {
      parameters.Reject("parts", fmt::format("names no part: {}", word));
    }
  }
  return parts;
}

}  // namespace

Response GetStatus(const Sources& sources, const RoutedRequest& request) {
  if (const auto problem = Parameters(request.query).Problem()) return ErrorResponse(*problem);
  return JsonResponse(view::ToJson(sources.queries.Status(), sources.monitor.readiness().all()));
}

bool RobotsReadStore(const RoutedRequest& request) {
  Parameters parameters(request.query);
  return ReadParts(parameters).AnyStored();
}

Response GetRobots(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  view::RobotsQuery query;
  query.fleet = parameters.Text("fleet");
  query.presence = ReadPresence(parameters);
  query.parts = ReadParts(parameters);
  query.page_size = ReadPageSize(parameters);
  query.page_token = parameters.TextOrEmpty("pageToken");
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  const absl::StatusOr<view::RobotsPage> page = sources.queries.Robots(query);
  return page.ok() ? JsonResponse(view::ToJson(*page, query.parts)) : ErrorResponse(page.status());
}

Response GetRobot(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  const std::string ruri = request.segment.empty() ? parameters.Text("ruri") : request.segment;
  if (ruri.empty()) parameters.Reject("ruri", "is missing: name the robot");
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  const absl::StatusOr<view::RobotView> robot = sources.queries.Robot(ruri);
  return robot.ok() ? JsonResponse(view::ToJson(*robot, view::PartSet::All()))
                    : ErrorResponse(robot.status());
}

}  // namespace uplink::http
