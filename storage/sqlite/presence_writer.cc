#include "storage/sqlite/presence_writer.h"

#include <optional>
#include <vector>

#include "storage/bounds.h"
#include "storage/sqlite/tables.h"

namespace uplink::storage::sqlite {
namespace {

absl::Status TrimServerSessions(DecidingTables& deciding, const model::SessionId& present) {
  const absl::StatusOr<std::vector<model::SessionId>> sessions = deciding.Sessions(kServerRuri);
  if (!sessions.ok()) return sessions.status();
  std::size_t kept = sessions->size();
  for (const model::SessionId& session : *sessions) {
    if (kept <= kServerSessionsMax) break;
    if (session == present) continue;
    absl::Status deleted = deciding.DeleteSession(kServerRuri, session);
    if (!deleted.ok()) return deleted;
    --kept;
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status WritePresence(Tables& tables, Decider& decider, const Batch& batch,
                           EntryNumber& next_entry, std::vector<Outcome>& outcomes) {
  if (batch.presence.empty()) return absl::OkStatus();
  const absl::StatusOr<std::optional<SessionCursor>> stored =
      tables.deciding.FindSession(kServerRuri, batch.presence_session);
  if (!stored.ok()) return stored.status();
  const SessionCursor row = stored->value_or(SessionCursor{0, next_entry});
  KnownSession session;
  session.cursor = row.cursor;
  for (const PresenceItem& item : batch.presence) {
    const absl::StatusOr<OutcomeKind> outcome = decider.Decide(item, session);
    if (!outcome.ok()) return outcome.status();
    outcomes.push_back({*outcome, std::nullopt});
    if (*outcome != OutcomeKind::kStored) continue;
    const PresenceChange change = {&item, next_entry++};
    absl::Status written = tables.rows.Write<kPresenceChangesTable>(change);
    if (written.ok()) written = tables.rows.Write<kLatestPresenceTable>(change);
    if (!written.ok()) return written;
  }
  absl::Status raised =
      tables.deciding.RaiseCursor(kServerRuri, batch.presence_session,
                                  {session.cursor, row.first_entry}, batch.presence.back().at);
  if (!raised.ok() || stored->has_value()) return raised;
  return TrimServerSessions(tables.deciding, batch.presence_session);
}

}  // namespace uplink::storage::sqlite
