#pragma once

#include <absl/status/statusor.h>

#include "server/http/errors.h"
#include "server/http/handlers.h"
#include "server/http/parameters.h"
#include "server/view/rows_json.h"
#include "storage/reader.h"

// What answers with rows of the store share. Thread: as their handlers.
namespace uplink::http {

template <typename Row>
[[nodiscard]] Response RowsResponse(const absl::StatusOr<storage::Page<Row>>& page) {
  return page.ok() ? JsonResponse(view::ToJson(*page)) : ErrorResponse(page.status());
}

/// Which part of a list.
[[nodiscard]] inline storage::HistoryQuery ReadPage(Parameters& parameters) {
  storage::HistoryQuery query;
  query.page_size = ReadPageSize(parameters);
  query.page_token = parameters.TextOrEmpty("pageToken");
  return query;
}

inline void ReadTimes(Parameters& parameters, storage::HistoryQuery& query) {
  query.from = parameters.Time("from");
  query.to = parameters.Time("to");
}

/// The handler of a history of the one robot that the path names; `kList` is a list of
/// storage::Reader, such as `&storage::Reader::Events`.
template <auto kList>
[[nodiscard]] Response GetHistory(const Sources& sources, const RoutedRequest& request) {
  Parameters parameters(request.query);
  storage::HistoryQuery query = ReadPage(parameters);
  ReadTimes(parameters, query);
  if (const auto problem = parameters.Problem()) return ErrorResponse(*problem);
  query.ruri = request.segment;
  return RowsResponse(sources.queries.History(kList, query));
}

}  // namespace uplink::http
