#pragma once

#include <string>
#include <utility>

#include <absl/status/statusor.h>

#include "schema/model/rejection.h"
#include "server/view/json.h"
#include "server/view/list_text.h"
#include "server/view/messages.h"
#include "storage/reader.h"

namespace uplink::view {

// The empty response for each kind of row.
[[nodiscard]] inline v1::ListFaultsResponse ResponseOf(const storage::FaultRow* /*row*/) {
  return {};
}
[[nodiscard]] inline v1::ListEventsResponse ResponseOf(const storage::EventRow* /*row*/) {
  return {};
}
[[nodiscard]] inline v1::ListMessagesResponse ResponseOf(const storage::MessageRow* /*row*/) {
  return {};
}
[[nodiscard]] inline v1::ListPresenceChangesResponse ResponseOf(
    const storage::PresenceRow* /*row*/) {
  return {};
}
[[nodiscard]] inline v1::ListConnectionsResponse ResponseOf(const storage::ConnectionRow* /*row*/) {
  return {};
}
[[nodiscard]] inline v1::ListQuarantineResponse ResponseOf(const storage::QuarantineRow* /*row*/) {
  return {};
}
[[nodiscard]] inline v1::ListGapsResponse ResponseOf(const storage::GapRow* /*row*/) { return {}; }
[[nodiscard]] inline v1::ListScopeUpdatesResponse ResponseOf(
    const storage::ScopeUpdateRow* /*row*/) {
  return {};
}
[[nodiscard]] inline v1::ListMissionsResponse ResponseOf(const storage::MissionRunRow* /*row*/) {
  return {};
}
[[nodiscard]] inline v1::ListMissionReportsResponse ResponseOf(
    const storage::MissionReportRow* /*row*/) {
  return {};
}
[[nodiscard]] inline v1::ListOperatorRequestsResponse ResponseOf(
    const storage::OperatorRequestRow* /*row*/) {
  return {};
}
[[nodiscard]] inline v1::ListShapesResponse ResponseOf(const storage::ShapeRow* /*row*/) {
  return {};
}
[[nodiscard]] inline v1::ListObjectsResponse ResponseOf(const storage::ObjectRow* /*row*/) {
  return {};
}

/// The page as the list of a response, which has none yet.
template <typename Response, typename Row>
[[nodiscard]] absl::StatusOr<std::string> RowsIn(Form form, Response response,
                                                 const storage::Page<Row>& page) {
  response.set_next_page_token(page.next_token);
  ListText list(form);
  for (const Row& row : page.rows) {
    const absl::Status added = list.Add(ToMessage(row), TextsOf(row));
    if (!added.ok()) return added;
  }
  return list.TakeIn(response);
}

/// A list of the store's rows, of any kind that messages.h maps. Errors and thread: as json.h.
template <typename Row>
[[nodiscard]] absl::StatusOr<std::string> Encode(Form form, const storage::Page<Row>& page) {
  return RowsIn(form, ResponseOf(static_cast<const Row*>(nullptr)), page);
}

[[nodiscard]] inline absl::StatusOr<std::string> Encode(Form form, const StoryPage& page) {
  v1::GetRobotStoryResponse response;
  response.set_next_page_token(page.next_token);
  ListText list(form);
  for (const StoryEntry& entry : page.entries) {
    const absl::Status added = list.Add(ToMessage(entry), TextsOf(entry));
    if (!added.ok()) return added;
  }
  return list.TakeIn(response);
}

[[nodiscard]] inline absl::StatusOr<std::string> Encode(Form form,
                                                        const QuarantineView& quarantine) {
  v1::ListQuarantineResponse response;
  for (const storage::DroppedRow& dropped : quarantine.dropped) {
    (*response.mutable_dropped_by_reason())[std::string(model::ToText(dropped.reason))] =
        Signed(dropped.count);
  }
  return RowsIn(form, std::move(response), quarantine.page);
}

}  // namespace uplink::view
