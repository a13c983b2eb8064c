#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <absl/status/statusor.h>
#include <fmt/format.h>

#include "schema/model/enum_text.h"
#include "server/http/errors.h"
#include "server/http/handlers.h"
#include "server/http/parameters.h"
#include "server/identity/scope.h"
#include "server/view/rows_json.h"
#include "storage/reader.h"

// What answers with rows of the store share. Thread: as their handlers.
namespace uplink::http {

template <typename Row>
[[nodiscard]] Response RowsResponse(const RoutedRequest& request,
                                    const absl::StatusOr<storage::Page<Row>>& page) {
  return page.ok() ? JsonResponse(view::Encode(request.form, *page)) : ErrorResponse(page.status());
}

/// The answer of a list of storage::Reader, such as `&storage::Reader::Events`, once all parameters
/// are read.
template <typename Row, typename Query>
[[nodiscard]] Response ListResponse(const Sources& sources, const RoutedRequest& request,
                                    Parameters& parameters, storage::ListOfReader<Row, Query> list,
                                    const Query& query) {
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  return RowsResponse(request, sources.queries.List(list, query));
}

/// Which part of a list.
inline void ReadPage(Parameters& parameters, storage::HistoryQuery& query) {
  query.page_size = ReadPageSize(parameters);
  query.page_token = parameters.TextOrEmpty("pageToken");
}

static_assert(identity::kScopeFleetsMax <= storage::kFleetsMax, "one question reads a scope");

/// The robots and fleets of a list. Rows of no robot are for callers of all fleets alone.
inline void ReadRobots(Parameters& parameters, const identity::Scope& scope,
                       storage::HistoryQuery& query) {
  query.fleets = scope.Restrict(parameters.Text("fleet"));
  query.robots_alone = !scope.all();
  query.ruris = parameters.Texts("ruri");
}

/// Of lists by arrival.
inline void ReadTimes(Parameters& parameters, storage::HistoryQuery& query) {
  query.from = parameters.Time("from");
  query.to = parameters.Time("to");
  const std::string order = parameters.Text("orderBy");
  if (order == "oldest") query.order = storage::ListOrder::kOldestFirst;
  if (order.empty() || order == "oldest" || order == "newest") return;
  parameters.Reject("orderBy", "must be oldest or newest");
}

/// What every history over the whole fleet takes.
[[nodiscard]] inline storage::HistoryQuery ReadRows(Parameters& parameters,
                                                    const identity::Scope& scope) {
  storage::HistoryQuery query;
  ReadRobots(parameters, scope, query);
  ReadTimes(parameters, query);
  ReadPage(parameters, query);
  return query;
}

/// A member of an enumeration by the specification's name; nothing: of any.
template <typename Enum>
[[nodiscard]] std::optional<Enum> ReadEnum(Parameters& parameters, std::string_view name) {
  const std::string text = parameters.Text(name);
  if (text.empty()) return std::nullopt;
  const std::optional<Enum> member = model::EnumFromText<Enum>(text);
  if (!member) {
    parameters.Reject(name,
                      fmt::format("must be one of {}", fmt::join(model::kEnumNames<Enum>, ", ")));
  }
  return member;
}

}  // namespace uplink::http
