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
  if (!*stored) return nullptr;
  const absl::StatusOr<std::optional<RobotHold>> claim = tables_.claims.ClaimOn(ruri);
  if (!claim.ok()) return claim.status();
  const auto if_own = [this](const std::optional<RobotHold>& hold) {
    return hold && hold->owner == process_ ? std::optional(hold->epoch) : std::nullopt;
  };
  KnownRobot& robot = robots_[ruri].known;
  robot.held_since = if_own(*stored);
  robot.claim = if_own(*claim);
  return &robot;
}

absl::StatusOr<KnownSamples*> BatchKnown::Samples(const CommitRecord& record) {
  const std::uint32_t type = record.sample->type;
  const auto [found, is_new] = robot(record.robot->ruri).samples.try_emplace(type);
  if (is_new) {
    absl::StatusOr<SampleMemory> memory = tables_.claims.Samples(record.robot->ruri, type);
    if (!memory.ok()) return memory.status();
    found->second.memory = *std::move(memory);
  }
  return &found->second;
}

absl::StatusOr<KnownRobot::RequestIds> BatchKnown::OpenRequests(std::string_view ruri) {
  return tables_.claims.OpenRequests(ruri);
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
