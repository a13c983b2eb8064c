// The handlers of /api/v1 that answer rows of the store.
#include <optional>
#include <string>

#include <absl/status/statusor.h>

#include "schema/model/cyberwave/uuid.h"
#include "schema/model/message_source.h"
#include "schema/model/scope_update.h"
#include "server/http/errors.h"
#include "server/http/handlers.h"
#include "server/http/parameters.h"
#include "server/http/rows.h"

namespace uplink::http {
namespace {

using storage::HistoryQuery;
using storage::Page;

void ReadRobots(Parameters& parameters, HistoryQuery& query) {
  query.ruri = parameters.Text("ruri");
  query.fleet = parameters.Text("fleet");
}

/// Nothing: every source.
std::optional<model::MessageSource> ReadSource(Parameters& parameters) {
  const std::string text = parameters.Text("source");
  if (text.empty()) return std::nullopt;
  const std::optional<model::MessageSource> source = model::MessageSourceFromText(text);
  if (!source) parameters.Reject("source", "must be uplink, cyberwave or uncrew");
  return source;
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

Response QuarantineResponse(const absl::StatusOr<view::QuarantineView>& quarantine) {
  return quarantine.ok() ? JsonResponse(view::ToJson(*quarantine))
                         : ErrorResponse(quarantine.status());
}

/// Shapes or objects.
template <typename Row>
Response PresentOnes(const std::string& query_text, view::Queries& queries,
                     absl::StatusOr<Page<Row>> (view::Queries::*ask)(storage::PresentQuery)) {
  Parameters parameters(query_text);
  storage::PresentQuery query;
  query.rows = ReadPage(parameters);
  ReadRobots(parameters, query.rows);
  query.include_expired = parameters.Flag("includeExpired");
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  return RowsResponse((queries.*ask)(query));
}

}  // namespace

Response GetQuarantine(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  HistoryQuery query = ReadPage(parameters);
  ReadTimes(parameters, query);
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  query.ruri = request.segment;
  return QuarantineResponse(sources.queries.Quarantine(query));
}

Response GetAllQuarantine(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  storage::QuarantineQuery query;
  query.rows = ReadPage(parameters);
  ReadTimes(parameters, query.rows);
  ReadRobots(parameters, query.rows);
  query.source = ReadSource(parameters);
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  return QuarantineResponse(sources.queries.AllQuarantine(query));
}

Response GetScopeUpdates(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  storage::ScopeUpdatesQuery query;
  query.rows = ReadPage(parameters);
  ReadTimes(parameters, query.rows);
  query.rows.fleet = parameters.Text("fleet");
  query.scope = ReadScope(parameters);
  query.id = ReadUuid(parameters, "id");
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  return RowsResponse(sources.queries.ScopeUpdates(query));
}

Response GetFaults(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  HistoryQuery query = ReadPage(parameters);
  ReadTimes(parameters, query);
  ReadRobots(parameters, query);
  const bool active = parameters.Flag("active");
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  return RowsResponse(active ? sources.queries.FaultsActive(query)
                             : sources.queries.FaultHistory(query));
}

Response GetMissions(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  storage::MissionsQuery query;
  query.rows = ReadPage(parameters);
  ReadRobots(parameters, query.rows);
  query.mission_id = parameters.Text("missionId");
  query.run_id = parameters.Text("runId");
  query.open = parameters.Flag("open");
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  return RowsResponse(sources.queries.MissionRuns(query));
}

Response GetOperatorRequests(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  storage::OperatorRequestsQuery query;
  query.rows = ReadPage(parameters);
  ReadTimes(parameters, query.rows);
  ReadRobots(parameters, query.rows);
  query.open = parameters.Flag("open");
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  return RowsResponse(sources.queries.OperatorRequests(query));
}

Response GetShapes(const Sources& sources, const RoutedRequest& request) {
  return PresentOnes(request.query, sources.queries, &view::Queries::Shapes);
}

Response GetObjects(const Sources& sources, const RoutedRequest& request) {
  return PresentOnes(request.query, sources.queries, &view::Queries::Objects);
}

}  // namespace uplink::http
