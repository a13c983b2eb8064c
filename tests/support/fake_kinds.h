#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "schema/model/mission.h"
#include "storage/commit_record.h"
#include "storage/latest_kind.h"
#include "storage/reader.h"
#include "storage/store_rules.h"
#include "tests/support/fake_present.h"

namespace uplink::testing {

/// The rows of every durable kind but faults, as a FakeDatabase keeps them. Confined to its lock.
class FakeKinds final {
 public:
  FakeKinds() = default;
  FakeKinds(const FakeKinds&) = delete;
  FakeKinds& operator=(const FakeKinds&) = delete;
  void CopyRowsOf(const FakeKinds& other);

  template <typename Row>
  using History = std::vector<FakeEntry<Row>>;
  /// RURI, mission, run.
  using RunKey = std::tuple<std::string, std::string, std::string>;
  struct Run : FakeEntry<storage::MissionRunRow> {
    /// Of the latest report.
    std::uint64_t last_entry = 0;

    [[nodiscard]] bool open() const {
      return !model::IsTerminal(row.status) && row.closed == storage::RunClosed::kNot;
    }
  };
  using Runs = std::map<RunKey, Run>;
  using LatestRows = std::map<std::pair<std::string, storage::LatestKind>, storage::LatestRow>;

  /// Why a bound refuses the record; nothing if none does.
  [[nodiscard]] std::optional<model::Rejection> Refusal(const storage::CommitRecord& record,
                                                        const storage::StoreRules& rules) const;

  /// Writes a good record that no bound refuses; a fault is none of ours. `entry` is above that of
  /// all rows before.
  void Write(const storage::CommitRecord& record, std::uint64_t entry,
             const storage::StoreRules& rules);

  /// As storage::Store::Sweep, for shapes and objects.
  std::size_t Sweep(SystemTime now);
  /// The same for changes.
  std::size_t SweepChanges() { return changes_.Sweep(); }
  /// A robot takes its shapes and objects to the fleet that it belongs to from now on.
  void Move(const model::RobotId& robot) {
    shapes_.Move(robot.ruri, robot.fleet);
    objects_.Move(robot.ruri, robot.fleet);
  }
  /// A robot's shapes, objects and requests go with it.
  void DeletePresent(const std::string& ruri) {
    std::erase_if(requests_, [&ruri](const auto& entry) { return entry.row.robot.ruri == ruri; });
    shapes_.DeleteAll(ruri);
    objects_.DeleteAll(ruri);
  }
  void NoteChange(storage::ItemKey key) { changes_.Note(std::move(key)); }
  /// As storage::Store::CloseRuns.
  std::size_t CloseRuns(SystemTime now);
  /// How many Write closed for their bound.
  [[nodiscard]] std::size_t runs_closed() const { return runs_closed_; }
  /// As storage::Store::Retain, with the first day that is kept.
  std::size_t EraseHistory(SystemTime until);

  [[nodiscard]] const History<storage::EventRow>& events() const { return events_; }
  [[nodiscard]] const History<storage::MessageRow>& messages() const { return messages_; }
  [[nodiscard]] const History<storage::MissionReportRow>& reports() const { return reports_; }
  [[nodiscard]] const History<storage::ScopeUpdateRow>& scope_updates() const {
    return scope_updates_;
  }
  [[nodiscard]] const History<storage::OperatorRequestRow>& requests() const { return requests_; }
  [[nodiscard]] const Runs& runs() const { return runs_; }
  [[nodiscard]] const FakePresent<storage::ShapeRow>& shapes() const { return shapes_; }
  [[nodiscard]] const FakePresent<storage::ObjectRow>& objects() const { return objects_; }
  [[nodiscard]] const FakeChanges& changes() const { return changes_; }
  [[nodiscard]] const LatestRows& latest() const { return latest_; }
  /// As storage::OpenResult has them.
  [[nodiscard]] storage::LatestKindSet LatestKinds(const std::string& ruri) const;
  /// The latest message of this kind goes.
  void EraseLatest(const std::string& ruri, storage::LatestKind kind) {
    latest_.erase({ruri, kind});
  }

 private:
  struct Target {
    const storage::CommitRecord& record;
    std::uint64_t entry;
    const storage::StoreRules& rules;
  };

  void WriteEvent(const Target& target, const model::EventTelemetry& event);
  void WriteMessage(const Target& target, const model::Message& message);
  /// The row that is open; null if there is none.
  [[nodiscard]] FakeEntry<storage::OperatorRequestRow>* OpenRequest(const std::string& ruri,
                                                                    const std::string& request_id);
  [[nodiscard]] bool TakesRequest(const storage::CommitRecord& record,
                                  const model::OperatorRequest& request) const;
  void WriteRequest(const Target& target, const model::OperatorRequest& request);
  void TrimRequests(const std::string& ruri);
  void WriteReport(const Target& target, const model::MissionRunStatus& report);
  void CloseRunsOver(const std::string& ruri, SystemTime at);
  void WriteShape(const Target& target, const model::ShapeOp& shape);
  void WriteObject(const Target& target, const model::ObjectOp& object);
  void WriteLatest(const Target& target, storage::LatestKind kind, std::string body_json);

  History<storage::EventRow> events_;
  History<storage::MessageRow> messages_;
  History<storage::MissionReportRow> reports_;
  History<storage::ScopeUpdateRow> scope_updates_;
  History<storage::OperatorRequestRow> requests_;
  Runs runs_;
  FakeChanges changes_;
  FakePresent<storage::ShapeRow> shapes_{storage::PresentKind::kShape, changes_};
  FakePresent<storage::ObjectRow> objects_{storage::PresentKind::kObject, changes_};
  LatestRows latest_;
  std::size_t runs_closed_ = 0;
};

}  // namespace uplink::testing
