#pragma once

#include <variant>

#include "schema/model/mission.h"
#include "schema/model/record.h"
#include "storage/commit_record.h"

namespace uplink::storage {

/// Whether the record reports a mission run that goes on: its robot may have one too many open now.
[[nodiscard]] inline bool LeavesRunOpen(const CommitRecord& record) {
  const auto* good = std::get_if<model::Record>(&record.content);
  if (good == nullptr) return false;
  const auto* report = std::get_if<model::MissionRunStatus>(&good->body());
  return report != nullptr && !model::IsTerminal(report->status);
}

}  // namespace uplink::storage
