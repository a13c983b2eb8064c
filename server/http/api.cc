// The handlers of /api/v1.
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <absl/status/statusor.h>
#include <fmt/core.h>

#include "server/http/errors.h"
#include "server/http/site.h"
#include "server/view/json.h"
#include "server/view/parts.h"

namespace uplink::http {
namespace {

Response JsonResponse(absl::StatusOr<std::string> json) {
  if (!json.ok()) return ErrorResponse(json.status());
  Response response;
  response.body = std::move(*json);
  return response;
}

template <typename Result>
Response RowsResponse(const absl::StatusOr<Result>& rows) {
  return rows.ok() ? JsonResponse(view::ToJson(*rows)) : ErrorResponse(rows.status());
}

std::optional<fleet::Presence> ReadPresence(Parameters& parameters) {
  const std::string text = parameters.Text("presence");
  if (text.empty()) return std::nullopt;
  for (const fleet::Presence presence :
       {fleet::Presence::kUnknown, fleet::Presence::kOnline, fleet::Presence::kOffline}) {
    if (fleet::ToText(presence) == text) return presence;
  }
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
      parameters.Reject("parts", fmt::format("names no live part: {}", word));
    }
  }
  return parts;
}

storage::HistoryQuery ReadHistory(Parameters& parameters) {
  storage::HistoryQuery query;
  query.from = parameters.Time("fromMs");
  query.to = parameters.Time("toMs");
  query.page_size = parameters.Number("pageSize", storage::kPageSizeDefault, storage::kPageSizeMax);
  query.page_token = parameters.Text("pageToken");
  return query;
}

}  // namespace

Response Site::Status(const Call& call) const {
  if (const auto problem = Parameters(call.query).Problem()) return ErrorResponse(*problem);
  return JsonResponse(view::ToJson(queries_.Status(), monitor_.readiness().degraded));
}

Response Site::Robots(const Call& call) const {
  Parameters parameters(call.query);
  view::RobotsQuery query;
  query.fleet = parameters.Text("fleet");
  query.presence = ReadPresence(parameters);
  query.parts = ReadParts(parameters);
  query.page_size = parameters.Number("pageSize", storage::kPageSizeDefault, storage::kPageSizeMax);
  query.page_token = parameters.Text("pageToken");
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  const absl::StatusOr<view::RobotsPage> page = queries_.Robots(query);
  return page.ok() ? JsonResponse(view::ToJson(*page, query.parts)) : ErrorResponse(page.status());
}

Response Site::Robot(const Call& call) const {
  if (const auto problem = Parameters(call.query).Problem()) return ErrorResponse(*problem);
  const absl::StatusOr<view::RobotView> robot = queries_.Robot(call.segment);
  return robot.ok() ? JsonResponse(view::ToJson(*robot, view::PartSet::All()))
                    : ErrorResponse(robot.status());
}

Response Site::Quarantine(const Call& call) const {
  Parameters parameters(call.query);
  storage::HistoryQuery query = ReadHistory(parameters);
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  query.ruri = call.segment;
  return RowsResponse(queries_.Quarantine(query));
}

Response Site::Gaps(const Call& call) const {
  Parameters parameters(call.query);
  storage::HistoryQuery query = ReadHistory(parameters);
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  query.ruri = call.segment;
  return RowsResponse(queries_.Gaps(query));
}

Response Site::Faults(const Call& call) const {
  Parameters parameters(call.query);
  storage::HistoryQuery query = ReadHistory(parameters);
  query.ruri = parameters.Text("ruri");
  query.fleet = parameters.Text("fleet");
  const bool active = parameters.Flag("active");
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  return RowsResponse(active ? queries_.FaultsActive(query) : queries_.FaultHistory(query));
}

}  // namespace uplink::http
