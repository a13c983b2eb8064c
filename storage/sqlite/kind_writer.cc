#include "storage/sqlite/kind_writer.h"

#include <variant>

#include "schema/base/check.h"
#include "schema/json/text.h"

namespace uplink::storage::sqlite {

/// One overload per alternative of the body.
struct KindWriter::Visitor {
  Tables& tables;
  EntryNumber& next_entry;
  const CommitRecord& record;
  const Ruling& ruling;

  absl::Status operator()(const model::Fault& fault) const {
    const EntryNumber entry = next_entry++;
    absl::Status status = tables.faults.InsertHistory(record, fault, entry);
    if (!status.ok()) return status;
    return fault.active ? tables.faults.Raise(record, fault, entry) : Remove();
  }
  absl::Status operator()(const model::EventTelemetry& event) const {
    return tables.history.Insert(record, event, next_entry++);
  }
  absl::Status operator()(const model::Message& message) const {
    return tables.history.Insert(record, message, next_entry++);
  }
  absl::Status operator()(const model::MissionRunStatus& report) const {
    return tables.missions.Insert(record, report, next_entry++);
  }
  absl::Status operator()(const model::AgentInfo& info) const {
    return tables.latest.Upsert(record, LatestKind::kAgentInfo, json::Text(info));
  }
  absl::Status operator()(const model::CurrentSettings& settings) const {
    return tables.latest.Upsert(record, LatestKind::kSettings, json::Text(settings));
  }
  absl::Status operator()(const model::UiCapabilities& capabilities) const {
    return tables.latest.Upsert(record, LatestKind::kUiCapabilities, json::Text(capabilities));
  }
  absl::Status operator()(const model::ShapeOp& op) const { return Spatial(op.upsert()); }
  absl::Status operator()(const model::ObjectOp& op) const { return Spatial(op.upsert()); }
  template <typename Live>
  absl::Status operator()(const Live& /*body*/) const {
    CheckFailed(__FILE__, __LINE__, "durable", "a live record reached the store");
  }

 private:
  /// A deletion if there is no upsert.
  template <typename Body>
  absl::Status Spatial(const Body* upsert) const {
    if (upsert == nullptr) return Remove();
    return tables.spatial.Upsert(record, *upsert, ruling.change->expires_ms, next_entry++);
  }
  absl::Status Remove() const {
    if (!ruling.was_present) return absl::OkStatus();
    return tables.present_rows(ruling.change->key.kind).Delete(ruling.change->key);
  }
};

absl::Status KindWriter::Write(const CommitRecord& record, const Ruling& ruling) {
  return std::visit(Visitor{tables_, next_entry_, record, ruling},
                    std::get<model::Record>(record.content).body());
}

}  // namespace uplink::storage::sqlite
