#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "storage/access_store.h"
#include "tests/support/fake_present.h"

namespace uplink::testing {

/// What operators decided and did, as a FakeDatabase has it. Confined to its lock.
struct FakeAccess {
  storage::AccessVersion version = 0;
  std::map<std::pair<storage::RevokedBy, std::string>, storage::Revocation> revocations;
  std::map<std::string, storage::RobotSetting> settings;
  /// In the order of their entries.
  std::vector<FakeEntry<storage::AuditRow>> audit;

  /// Labels and note go with the robot.
  void DropNotes(const std::string& ruri) {
    const auto found = settings.find(ruri);
    if (found == settings.end()) return;
    storage::RobotSetting& setting = found->second;
    if (setting.labels.empty() && setting.note.empty()) return;
    setting.labels.clear();
    setting.note.clear();
    setting.version = ++version;
  }
};

}  // namespace uplink::testing
