#include "tests/support/fake_presence.h"

#include <algorithm>

namespace uplink::testing {

void FakePresence::Write(const storage::Batch& batch, std::uint64_t& entries, bool no_cursor) {
  if (batch.presence.empty()) return;
  Session& session = sessions_[batch.presence_session];
  for (const storage::PresenceItem& item : batch.presence) {
    if (!no_cursor && item.number <= session.cursor) continue;
    session.cursor = item.number;
    changes_.push_back({item.at, ++entries, {*item.robot, item.presence, item.at}});
    storage::PresenceRow& last = last_[item.robot->ruri];
    if (last.at <= item.at) last = changes_.back().row;
  }
  session.last_used = entries;
  if (sessions_.size() > storage::kServerSessionsMax) {
    sessions_.erase(std::ranges::min_element(
        sessions_, {}, [](const auto& known) { return known.second.last_used; }));
  }
}

std::optional<storage::PresenceRow> FakePresence::Last(std::string_view ruri) const {
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
