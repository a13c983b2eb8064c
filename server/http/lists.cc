// The handlers of /api/v1 that answer rows of the store.
#include <optional>
#include <string>

#include <absl/status/statusor.h>

#include "schema/model/connection.h"
#include "schema/model/cyberwave/uuid.h"
#include "schema/model/message_source.h"
#include "schema/model/rejection.h"
#include "schema/model/scope_update.h"
#include "server/http/errors.h"
#include "server/http/handlers.h"
#include "server/http/parameters.h"
#include "server/http/rows.h"

namespace uplink::http {
namespace {

using storage::Reader;

/// Nothing: every source.
std::optional<model::MessageSource> ReadSource(Parameters& parameters) {
  const std::string text = parameters.Text("source");
  if (text.empty()) return std::nullopt;
  const std::optional<model::MessageSource> source = model::MessageSourceFromText(text);
  if (!source) parameters.Reject("source", "must be uplink, cyberwave or uncrew");
  return source;
}

/// Nothing: every reason.
std::optional<model::RejectReason> ReadReason(Parameters& parameters) {
  const std::string text = parameters.Text("reason");
  if (text.empty()) return std::nullopt;
  const std::optional<model::RejectReason> reason = model::RejectReasonFromText(text);
  if (!reason) parameters.Reject("reason", "is none of the reject reasons, such as out_of_range");
  return reason;
}

/// Nothing: whyever it ended.
std::optional<model::ConnectionEnd> ReadWhy(Parameters& parameters) {
  const std::string text = parameters.Text("why");
  if (text.empty()) return std::nullopt;
  const std::optional<model::ConnectionEnd> why = model::ConnectionEndFromText(text);
  if (!why) parameters.Reject("why", "is none of the reasons of an end, such as silent");
  return why;
}

/// Nothing: every scope.
std::optional<model::ScopeKind> ReadScope(Parameters& parameters) {
  const std::string text = parameters.Text("scope");
  if (text.empty()) return std::nullopt;
  const std::optional<model::ScopeKind> scope = model::ScopeKindFromText(text);
  if (!scope) parameters.Reject("scope", "must be environment or workflow_run");
  return scope;
}

/// In the spelling of the rows; empty: every id.
std::string ReadUuid(Parameters& parameters, std::string_view name) {
  std::string text = parameters.Text(name);
  if (text.empty()) return text;
  const auto id = model::cyberwave::Uuid::FromText(text);
  if (id) return id->ToText();
  parameters.Reject(name, "must be a UUID: 8-4-4-4-12 hex digits");
  return {};
}

/// Of runs and of their reports.
storage::MissionsQuery ReadMissions(Parameters& parameters, const identity::Scope& scope) {
  storage::MissionsQuery query;
  query.rows = ReadRows(parameters, scope);
  query.mission_id = parameters.Text("missionId");
  query.run_id = parameters.Text("runId");
  query.status = ReadEnum<model::MissionStatus>(parameters, "status");
  return query;
}

/// Shapes or objects.
template <typename Row>
Response PresentOnes(
    const RoutedRequest& request, view::Queries& queries,
    absl::StatusOr<storage::Page<Row>> (view::Queries::*ask)(storage::PresentQuery)) {
  Parameters parameters(request.query);
  storage::PresentQuery query;
  ReadRobots(parameters, request.caller.scope, query.rows);
  query.include_expired = parameters.Flag("includeExpired");
  ReadPage(parameters, query.rows);
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  return RowsResponse(request, (queries.*ask)(query));
}

}  // namespace

Response GetEvents(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  storage::EventsQuery query{.rows = ReadRows(parameters, request.caller.scope)};
  query.kind = parameters.Text("kind");
  return ListResponse(sources, request, parameters, &Reader::Events, query);
}

Response GetMessages(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  storage::MessagesQuery query{.rows = ReadRows(parameters, request.caller.scope)};
  query.level = ReadEnum<model::MessageLevel>(parameters, "level");
  return ListResponse(sources, request, parameters, &Reader::Messages, query);
}

Response GetConnections(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  storage::ConnectionsQuery query{.rows = ReadRows(parameters, request.caller.scope)};
  query.open = parameters.Flag("open");
  query.why = ReadWhy(parameters);
  query.source = ReadSource(parameters);
  return ListResponse(sources, request, parameters, &Reader::Connections, query);
}

Response GetStory(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  storage::HistoryQuery rows;
  const std::string ruri = parameters.Text("ruri");
  if (ruri.empty()) parameters.Reject("ruri", "is missing: name the robot");
  ReadTimes(parameters, rows);
  ReadPage(parameters, rows);
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  const absl::StatusOr<view::StoryPage> story =
      sources.queries.Story({.ruri = ruri,
                             .fleets = request.caller.scope.Restrict(""),
                             .from = rows.from,
                             .to = rows.to,
                             .order = rows.order,
                             .page_size = rows.page_size,
                             .page_token = rows.page_token});
  return story.ok() ? JsonResponse(view::Encode(request.form, *story))
                    : ErrorResponse(story.status());
}

Response GetPresence(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  const storage::HistoryQuery query = ReadRows(parameters, request.caller.scope);
  return ListResponse(sources, request, parameters, &Reader::PresenceChanges, query);
}

Response GetGaps(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  const storage::HistoryQuery query = ReadRows(parameters, request.caller.scope);
  return ListResponse(sources, request, parameters, &Reader::Gaps, query);
}

Response GetQuarantine(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  storage::QuarantineQuery query{.rows = ReadRows(parameters, request.caller.scope)};
  query.source = ReadSource(parameters);
  query.reason = ReadReason(parameters);
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  const absl::StatusOr<view::QuarantineView> quarantine =
      sources.queries.Quarantine(query, request.caller.scope.Restrict(""));
  return quarantine.ok() ? JsonResponse(view::Encode(request.form, *quarantine))
                         : ErrorResponse(quarantine.status());
}

Response GetScopeUpdates(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  storage::ScopeUpdatesQuery query;
  // They belong to no robot, and so to no caller's fleets.
  const identity::Scope& scope = request.caller.scope;
  query.rows.fleets =
      (scope.all() ? scope : identity::Scope::Of({})).Restrict(parameters.Text("fleet"));
  ReadTimes(parameters, query.rows);
  ReadPage(parameters, query.rows);
  query.scope = ReadScope(parameters);
  query.id = ReadUuid(parameters, "id");
  return ListResponse(sources, request, parameters, &Reader::ScopeUpdates, query);
}

Response GetFaults(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  storage::FaultsQuery query{.rows = ReadRows(parameters, request.caller.scope)};
  query.severity = ReadEnum<model::FaultSeverity>(parameters, "severity");
  query.fault_id = parameters.Text("faultId");
  query.source = parameters.Text("source");
  const bool active = parameters.Flag("active");
  return ListResponse(sources, request, parameters,
                      active ? &Reader::FaultsActive : &Reader::FaultHistory, query);
}

Response GetMissions(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  storage::MissionsQuery query = ReadMissions(parameters, request.caller.scope);
  query.open = parameters.Flag("open");
  return ListResponse(sources, request, parameters, &Reader::MissionRuns, query);
}

Response GetMissionReports(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  const storage::MissionsQuery query = ReadMissions(parameters, request.caller.scope);
  return ListResponse(sources, request, parameters, &Reader::MissionReports, query);
}

Response GetOperatorRequests(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  storage::OperatorRequestsQuery query{.rows = ReadRows(parameters, request.caller.scope)};
  query.open = parameters.Flag("open");
  return ListResponse(sources, request, parameters, &Reader::OperatorRequests, query);
}

Response GetShapes(const Sources& sources, const RoutedRequest& request) {
  return PresentOnes(request, sources.queries, &view::Queries::Shapes);
}

Response GetObjects(const Sources& sources, const RoutedRequest& request) {
  return PresentOnes(request, sources.queries, &view::Queries::Objects);
}

}  // namespace uplink::http
