#include "storage/sqlite/kind_writer.h"

#include <optional>
#include <string>
#include <variant>

#include "schema/base/check.h"
#include "schema/json/text.h"
#include "storage/sqlite/tables.h"
#include "storage/tables/lists.h"

namespace uplink::storage::sqlite {

/// One overload per body that is more than a row of a history.
struct KindWriter::Visitor {
  Tables& tables;
  EntryNumber& next_entry;
  const CommitRecord& record;
  const Ruling& ruling;

  absl::Status operator()(const model::Fault& fault) const {
    const EntryNumber entry = next_entry++;
    absl::Status status = tables.rows.Write<kFaultHistoryTable>({&record, &fault, entry});
    if (!status.ok()) return status;
    if (!fault.active) return Remove();
    return tables.rows.Write<kFaultsActiveTable>({&record, &fault, 0, record.received_at, entry});
  }
  absl::Status operator()(const model::MissionRunStatus& report) const {
    const std::string text = json::Text(report);
    const MissionReport row = {&record, &report, text, next_entry++};
    absl::Status status = tables.rows.Write<kMissionReportsTable>(row);
    if (!status.ok()) return status;
    return tables.rows.Write<kMissionRunsTable>(MissionRun(row));
  }
  absl::Status operator()(const model::AgentInfo& /*body*/) const {
    return Latest(LatestKind::kAgentInfo);
  }
  absl::Status operator()(const model::CurrentSettings& /*body*/) const {
    return Latest(LatestKind::kSettings);
  }
  absl::Status operator()(const model::UiCapabilities& /*body*/) const {
    return Latest(LatestKind::kUiCapabilities);
  }
  absl::Status operator()(const model::ShapeOp& op) const {
    return Spatial<kShapesTable>(op.upsert());
  }
  absl::Status operator()(const model::ObjectOp& op) const {
    return Spatial<kObjectsTable>(op.upsert());
  }
  template <typename Body>
  absl::Status operator()(const Body& body) const {
    constexpr std::optional<PageKind> kHistory = HistoryOf<Body>();
    if constexpr (kHistory) {
      return tables.rows.Write<List<*kHistory>::kTable>({&record, &body, next_entry++});
    } else {
      static_assert(model::SettlingOf<Body>::kSettling == model::Settling::kLive,
                    "a durable kind has a table, or an overload above");
      CheckFailed(__FILE__, __LINE__, "durable", "a live record reached the store");
    }
  }

 private:
  absl::Status Latest(LatestKind kind) const {
    return tables.rows.Write<kLatestTable>({&record, kind});
  }
  /// A deletion if there is no upsert.
  template <const auto& kTable, typename Body>
  absl::Status Spatial(const Body* upsert) const {
    if (upsert == nullptr) return Remove();
    return tables.rows.Write<kTable>(
        {&record, upsert, ruling.change->expires_ms, record.received_at, next_entry++});
  }
  absl::Status Remove() const {
    if (!ruling.was_present) return absl::OkStatus();
    return tables.present_rows(ruling.change->key.kind).Delete(ruling.change->key);
  }
};

absl::Status KindWriter::Write(const CommitRecord& record, const Ruling& ruling) {
  if (const auto* update = std::get_if<model::ScopeUpdate>(&record.content)) {
    return tables_.rows.Write<kScopeUpdatesTable>({&record, update, next_entry_++});
  }
  if (const auto* request = std::get_if<model::OperatorRequest>(&record.content)) {
    if (request->open) {
      return tables_.rows.Write<kOperatorRequestsTable>({&record, request, next_entry_++});
    }
    return ruling.was_present ? tables_.claims.CloseRequest(record, *request) : absl::OkStatus();
  }
  return std::visit(Visitor{tables_, next_entry_, record, ruling},
                    std::get<model::Record>(record.content).body());
}

}  // namespace uplink::storage::sqlite
