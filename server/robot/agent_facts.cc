#include "server/robot/agent_facts.h"

namespace uplink::robot {

void AgentFacts::Begin(const storage::ConnectionItem& item) {
  const std::lock_guard lock(mutex_);
  if (!item.agent_version.empty()) version_ = item.agent_version;
  if (open_.size() >= kAgentConnectionsMax) open_.erase(open_.begin());
  open_.push_back({.id = item.id, .not_after = item.certificate.not_after});
}

void AgentFacts::End(const storage::ConnectionId& id) {
  const std::lock_guard lock(mutex_);
  std::erase_if(open_, [&id](const Open& open) { return open.id == id; });
}

std::optional<SystemTime> AgentFacts::certificate_not_after() const {
  const std::lock_guard lock(mutex_);
  return open_.empty() ? std::nullopt : open_.back().not_after;
}

AgentFacts::View AgentFacts::Get() const {
  const std::lock_guard lock(mutex_);
  View view{.version = version_, .certificate_not_after = {}};
  if (!open_.empty()) view.certificate_not_after = open_.back().not_after;
  return view;
}

}  // namespace uplink::robot
