#include "server/robot/session_table.h"

#include "server/robot/limits.h"

namespace uplink::robot {

SessionMemory* SessionTable::Find(const model::SessionId& session) {
  const auto found = sessions_.find(session);
  return found == sessions_.end() ? nullptr : &found->second;
}

const SessionMemory* SessionTable::Find(const model::SessionId& session) const {
  const auto found = sessions_.find(session);
  return found == sessions_.end() ? nullptr : &found->second;
}

bool SessionTable::MakeRoom() {
  if (sessions_.size() < kSessionsMax) return true;
  auto oldest = sessions_.end();
  for (auto it = sessions_.begin(); it != sessions_.end(); ++it) {
    if (it->second.numbers.waiting() > 0) continue;
    if (oldest == sessions_.end() || it->second.last_used < oldest->second.last_used) oldest = it;
  }
  if (oldest == sessions_.end()) return false;
  sessions_.erase(oldest);
  return true;
}

SessionMemory* SessionTable::FindOrCreate(const model::SessionId& session) {
  if (SessionMemory* memory = Find(session)) return memory;
  if (!MakeRoom()) return nullptr;
  return &sessions_.try_emplace(session).first->second;
}

std::vector<model::SessionId> SessionTable::Ids() const {
  std::vector<model::SessionId> ids;
  ids.reserve(sessions_.size());
  for (const auto& [id, memory] : sessions_) ids.push_back(id);
  return ids;
}

std::vector<storage::CommittedSession> SessionTable::Committed() const {
  std::vector<storage::CommittedSession> committed;
  for (const auto& [id, memory] : sessions_) {
    if (memory.committed > 0) committed.push_back({id, memory.committed});
  }
  return committed;
}

std::size_t SessionTable::waiting() const {
  std::size_t waiting = 0;
  for (const auto& [id, memory] : sessions_) waiting += memory.numbers.waiting();
  return waiting;
}

void SessionTable::ForgetIdle(SteadyTime now, milliseconds idle,
                              const std::optional<model::SessionId>& in_use) {
  std::erase_if(sessions_, [&](const auto& item) {
    return in_use != item.first && item.second.numbers.waiting() == 0 &&
           now - item.second.last_used > idle;
  });
}

}  // namespace uplink::robot
