#include "tests/support/fake_presence.h"

#include <algorithm>

namespace uplink::testing {

std::vector<storage::Outcome> FakePresence::Write(const storage::Batch& batch,
                                                  std::uint64_t& entries, const IsFenced& is_fenced,
                                                  bool no_cursor) {
  std::vector<storage::Outcome> outcomes(batch.presence.size());
  if (batch.presence.empty()) return outcomes;
  Session& session = sessions_[batch.presence_session];
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const storage::PresenceItem& item = batch.presence[i];
    if (is_fenced(item)) {
      outcomes[i].kind = storage::OutcomeKind::kFenced;
      continue;
    }
    if (!no_cursor && item.number <= session.cursor) {
      outcomes[i].kind = storage::OutcomeKind::kDuplicate;
      continue;
    }
    session.cursor = item.number;
    last_[item.robot->ruri] = {item.presence, item.at, item.parked_until};
    if (!item.changes_presence) continue;
    changes_.push_back({item.at, ++entries, {*item.robot, item.presence, item.at, item.why}});
  }
  session.last_used = entries;
  if (sessions_.size() > storage::kServerSessionsMax) {
    sessions_.erase(std::ranges::min_element(
        sessions_, {}, [](const auto& known) { return known.second.last_used; }));
  }
  return outcomes;
}

std::optional<storage::StoredPresence> FakePresence::Last(std::string_view ruri) const {
  const auto found = last_.find(ruri);
  if (found == last_.end()) return std::nullopt;
  return found->second;
}

std::optional<model::Seq> FakePresence::Cursor(const model::SessionId& session) const {
  const auto found = sessions_.find(session);
  if (found == sessions_.end()) return std::nullopt;
  return found->second.cursor;
}

}  // namespace uplink::testing
