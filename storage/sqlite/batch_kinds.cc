#include <variant>

#include "schema/base/check.h"
#include "schema/json/text.h"
#include "storage/expiry.h"
#include "storage/refusal.h"
#include "storage/sqlite/batch_commit.h"

// What a batch writes of each kind.
namespace uplink::storage::sqlite {

using model::Rejection;

/// One overload an alternative of the body.
struct BatchCommit::KindWriter {
  using Result = absl::StatusOr<std::optional<Rejection>>;

  BatchCommit& batch;
  Robot& robot;
  const CommitRecord& record;

  Result operator()(const model::Fault& fault) const {
    return batch.WriteFault(robot, record, fault);
  }
  Result operator()(const model::EventTelemetry& event) const {
    return Done(batch.tables_.history.Insert(record, event, batch.next_entry_++));
  }
  Result operator()(const model::Message& message) const {
    return Done(batch.tables_.history.Insert(record, message, batch.next_entry_++));
  }
  Result operator()(const model::MissionRunStatus& report) const {
    return Done(batch.tables_.missions.Insert(record, report, batch.next_entry_++));
  }
  Result operator()(const model::AgentInfo& info) const {
    return Done(batch.tables_.latest.Upsert(record, LatestKind::kAgentInfo, json::Text(info)));
  }
  Result operator()(const model::CurrentSettings& settings) const {
    return Done(batch.tables_.latest.Upsert(record, LatestKind::kSettings, json::Text(settings)));
  }
  Result operator()(const model::UiCapabilities& capabilities) const {
    return Done(
        batch.tables_.latest.Upsert(record, LatestKind::kUiCapabilities, json::Text(capabilities)));
  }
  Result operator()(const model::ShapeOp& op) const {
    PresentRows& rows = batch.tables_.shapes.rows();
    if (op.upsert() == nullptr) return Remove(rows, robot.shapes, op.id());
    const absl::StatusOr<bool> room = MakeRoom(rows, robot.shapes, op.id(), kShapesPerRobotMax);
    if (!room.ok()) return room.status();
    if (!*room) return std::optional<Rejection>(TooManyShapes());
    return Done(batch.tables_.shapes.Upsert(record, *op.upsert(), batch.next_entry_++));
  }
  Result operator()(const model::ObjectOp& op) const {
    PresentRows& rows = batch.tables_.objects.rows();
    if (op.upsert() == nullptr) return Remove(rows, robot.objects, op.id());
    const absl::StatusOr<bool> room = MakeRoom(rows, robot.objects, op.id(), kObjectsPerRobotMax);
    if (!room.ok()) return room.status();
    if (!*room) return std::optional<Rejection>(TooManyObjects());
    const std::int64_t expires_ms = ExpiryOf(*op.upsert(), record.received_at, batch.rules_);
    return Done(
        batch.tables_.objects.Upsert(record, *op.upsert(), expires_ms, batch.next_entry_++));
  }
  template <typename Live>
  Result operator()(const Live& /*body*/) const {
    CheckFailed(__FILE__, __LINE__, "durable", "a live record reached the store");
  }

 private:
  static Result Done(const absl::Status& status) {
    if (!status.ok()) return status;
    return std::optional<Rejection>();
  }

  Result Remove(PresentRows& rows, std::optional<std::size_t>& count, const std::string& id) const {
    const std::string_view ruri = record.robot->ruri;
    const absl::StatusOr<std::optional<std::int64_t>> expiry = rows.ExpiryOf(ruri, id);
    if (!expiry.ok()) return expiry.status();
    if (!expiry->has_value()) return std::optional<Rejection>();
    if (count) --*count;
    return Done(rows.Delete(ruri, id));
  }

  /// True if an upsert of the id may be written; `count` then counts it. A row of the id that has
  /// expired is gone then, so that the upsert is a new beginning.
  absl::StatusOr<bool> MakeRoom(PresentRows& rows, std::optional<std::size_t>& count,
                                const std::string& id, std::size_t rows_max) const {
    const std::string_view ruri = record.robot->ruri;
    const std::int64_t now_ms = UnixMs(record.received_at);
    const absl::StatusOr<std::optional<std::int64_t>> expiry = rows.ExpiryOf(ruri, id);
    if (!expiry.ok()) return expiry.status();
    if (expiry->has_value() && !IsExpired(**expiry, now_ms)) return true;
    if (expiry->has_value()) {
      absl::Status deleted = rows.Delete(ruri, id);
      if (!deleted.ok()) return deleted;
      if (count) --*count;
    }
    if (!count) {
      const absl::StatusOr<std::size_t> counted = rows.Count(ruri);
      if (!counted.ok()) return counted.status();
      count = *counted;
    }
    if (*count >= rows_max) {
      const absl::StatusOr<std::size_t> expired = rows.DeleteExpired(ruri, now_ms);
      if (!expired.ok()) return expired.status();
      *count -= *expired;
    }
    if (*count >= rows_max) return false;
    ++*count;
    return true;
  }
};

absl::StatusOr<std::optional<Rejection>> BatchCommit::WriteRecord(Robot& robot,
                                                                  const CommitRecord& record) {
  const auto& good = std::get<model::Record>(record.content);
  return std::visit(KindWriter{*this, robot, record}, good.body());
}

absl::Status BatchCommit::WritePresence(const Batch& batch) {
  if (batch.presence.empty()) return absl::OkStatus();
  DecidingTables& deciding = tables_.deciding;
  const absl::StatusOr<std::optional<SessionCursor>> stored =
      deciding.FindSession(kServerRuri, batch.presence_session);
  if (!stored.ok()) return stored.status();
  SessionCursor session = stored->value_or(SessionCursor{0, next_entry_});
  for (const PresenceItem& item : batch.presence) {
    if (item.number <= session.cursor) continue;
    absl::Status inserted = tables_.presence.Insert(item, next_entry_++);
    if (!inserted.ok()) return inserted;
    session.cursor = item.number;
  }
  absl::Status raised =
      deciding.RaiseCursor(kServerRuri, batch.presence_session, session, batch.presence.back().at);
  if (!raised.ok() || stored->has_value()) return raised;
  return TrimServerSessions(batch.presence_session);
}

absl::Status BatchCommit::TrimServerSessions(const model::SessionId& present) {
  const absl::StatusOr<std::vector<model::SessionId>> sessions =
      tables_.deciding.Sessions(kServerRuri);
  if (!sessions.ok()) return sessions.status();
  std::size_t kept = sessions->size();
  for (const model::SessionId& session : *sessions) {
    if (kept <= kServerSessionsMax) break;
    if (session == present) continue;
    absl::Status deleted = tables_.deciding.DeleteSession(kServerRuri, session);
    if (!deleted.ok()) return deleted;
    --kept;
  }
  return absl::OkStatus();
}

}  // namespace uplink::storage::sqlite
