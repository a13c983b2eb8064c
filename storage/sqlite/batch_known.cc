#include "storage/sqlite/batch_known.h"

#include <algorithm>
#include <utility>

#include "storage/sqlite/tables.h"

namespace uplink::storage::sqlite {

absl::StatusOr<KnownRobot*> BatchKnown::Robot(std::string_view ruri) {
  const auto found = robots_.find(ruri);
  if (found != robots_.end()) return &found->second.known;
  const absl::StatusOr<std::optional<RobotHold>> stored = tables_.deciding.HoldOf(ruri);
  if (!stored.ok()) return stored.status();
  if (!*stored || (*stored)->owner != process_) return nullptr;
  BatchRobot& robot = robots_[ruri];
  robot.known.held_since = (*stored)->epoch;
  return &robot.known;
}

absl::StatusOr<KnownSession*> BatchKnown::Session(const CommitRecord& record) {
  std::vector<BatchSession>& sessions = robot(record.robot->ruri).sessions;
  const auto found = std::ranges::find(sessions, record.session, &BatchSession::id);
  if (found != sessions.end()) return &found->known;
  const auto stored = tables_.deciding.FindSession(record.robot->ruri, record.session);
  if (!stored.ok()) return stored.status();
  const SessionCursor row = stored->value_or(SessionCursor{0, next_entry_});
  BatchSession& session = sessions.emplace_back();
  session.id = record.session;
  session.known.cursor = row.cursor;
  session.first_entry = row.first_entry;
  return &session.known;
}

absl::StatusOr<std::optional<model::Rejection>> BatchKnown::Rejected(const CommitRecord& record) {
  const std::vector<BatchSession>& sessions = robot(record.robot->ruri).sessions;
  const auto session = std::ranges::find(sessions, record.session, &BatchSession::id);
  RejectRange range;
  range.ruri = record.robot->ruri;
  range.session = record.session;
  range.first_entry = session->first_entry;
  range.through = record.seq;
  return tables_.set_aside.RejectionOf(range);
}

absl::StatusOr<Epoch> BatchKnown::LeaseEpoch(std::string_view client_id) {
  const auto found = leases_.find(client_id);
  if (found != leases_.end()) return found->second;
  absl::StatusOr<Epoch> stored = tables_.deciding.LeaseEpoch(client_id, process_);
  if (stored.ok()) leases_.emplace(client_id, *stored);
  return stored;
}

absl::StatusOr<std::optional<std::int64_t>> BatchKnown::ExpiryOf(const PresentKey& key) {
  return tables_.present_rows(key.kind).ExpiryOf(key);
}

absl::StatusOr<std::size_t> BatchKnown::Count(PresentKind kind, std::string_view ruri) {
  return tables_.present_rows(kind).Count(ruri);
}

absl::Status BatchKnown::Delete(const PresentKey& key) {
  return tables_.present_rows(key.kind).Delete(key);
}

absl::StatusOr<std::size_t> BatchKnown::DeleteExpired(PresentKind kind, std::string_view ruri,
                                                      std::int64_t now_ms) {
  return tables_.present_rows(kind).DeleteExpired(ruri, now_ms);
}

}  // namespace uplink::storage::sqlite
