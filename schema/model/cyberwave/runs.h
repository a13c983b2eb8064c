#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "schema/model/mission.h"
#include "schema/model/scope_update.h"

/// What goes on under an id of its own: actions, missions, environments, workflows. Durable.
namespace uplink::model::cyberwave {

/// Progress of one navigation, or of one mission. A value.
struct RunStatus {
  /// Of the action or of the mission's execution; never empty.
  std::string run_id;
  /// Ours for the vendor's word: queued is ready, completed complete, failed error, cancelled
  /// aborted; kUnknown for a word that we do not know.
  MissionStatus status = MissionStatus::kUnknown;
  /// The vendor's word; never empty.
  std::string status_text;
  std::string message;
  /// 0 to 100.
  std::optional<double> progress_percent;
  std::optional<std::uint64_t> current_step;

  friend bool operator==(const RunStatus&, const RunStatus&) = default;
};

using model::ScopeKind;

/// Something that changed in an environment or a workflow run; its id is the topic's. A value.
struct ScopeUpdate {
  ScopeKind scope = ScopeKind::kEnvironment;
  /// What changed; of a workflow run its status. Never empty.
  std::string type;
  /// The JSON text of the whole object, as in reports.h.
  std::string detail;

  friend bool operator==(const ScopeUpdate&, const ScopeUpdate&) = default;
};

}  // namespace uplink::model::cyberwave
