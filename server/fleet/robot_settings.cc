#include "server/fleet/robot_settings.h"

#include <optional>

#include "storage/access_rules.h"

namespace uplink::fleet {
namespace {

/// An earlier disconnect stays, so that it asks no stream to end again.
bool HoldsAnything(const storage::RobotSetting& setting) {
  return !storage::SetsNothing(setting) || setting.disconnect_at.has_value();
}

bool ChangesNothing(const RobotSettings::Change& change) {
  if (change.before == nullptr || change.now == nullptr) return change.before == change.now;
  return *change.before == *change.now;
}

bool AsksDisconnect(const RobotSettingPtr& before, const storage::RobotSetting& now) {
  const auto last = before == nullptr ? std::nullopt : before->disconnect_at;
  return now.disconnect_at.has_value() && now.disconnect_at != last;
}

}  // namespace

RobotSettingPtr RobotSettings::Find(std::string_view ruri) const {
  const std::lock_guard lock(mutex_);
  return FindLocked(ruri);
}

RobotSettingPtr RobotSettings::FindLocked(std::string_view ruri) const {
  for (const Table* table : {&decided_, &noted_}) {
    if (const auto found = table->find(ruri); found != table->end()) {
      return found->second;
    }
  }
  return nullptr;
}

std::vector<RobotSettingPtr> RobotSettings::All() const {
  std::vector<RobotSettingPtr> all;
  {
    const std::lock_guard lock(mutex_);
    all.reserve(decided_.size() + noted_.size());
    for (const Table* table : {&decided_, &noted_}) {
      for (const auto& [ruri, setting] : *table) {
        all.push_back(setting);
      }
    }
  }
  std::sort(all.begin(), all.end(), [](const RobotSettingPtr& one, const RobotSettingPtr& other) {
    return one->ruri < other->ruri;
  });
  return all;
}

std::size_t RobotSettings::size() const {
  const std::lock_guard lock(mutex_);
  return decided_.size() + noted_.size();
}

std::uint64_t RobotSettings::left_out() const {
  const std::lock_guard lock(mutex_);
  return left_out_;
}

void RobotSettings::Erase(const std::string& ruri) {
  decided_.erase(ruri);
  noted_.erase(ruri);
}

void RobotSettings::Put(storage::RobotSetting setting, std::vector<Change>& changes) {
  Change change{.ruri = setting.ruri, .before = FindLocked(setting.ruri), .now = nullptr};
  if (change.before != nullptr && setting.version <= change.before->version) {
    return;
  }
  change.disconnect = AsksDisconnect(change.before, setting);
  Erase(change.ruri);
  if (HoldsAnything(setting)) {
    const bool decides = storage::DecidesEntry(setting);
    const bool full = decided_.size() + noted_.size() >= settings_max_;
    left_out_ += full ? 1 : 0;
    if (full && decides && !noted_.empty()) {
      const auto lost = noted_.begin();
      changes.push_back({.ruri = lost->first, .before = lost->second, .now = nullptr});
      noted_.erase(lost);
    }
    if (!full || (decides && decided_.size() + noted_.size() < settings_max_)) {
      change.now = std::make_shared<const storage::RobotSetting>(std::move(setting));
      (decides ? decided_ : noted_).emplace(change.ruri, change.now);
    }
  }
  if (change.before != nullptr || change.now != nullptr || change.disconnect) {
    changes.push_back(std::move(change));
  }
}

void RobotSettings::Apply(std::vector<storage::RobotSetting> settings) {
  std::vector<Change> changes;
  {
    const std::lock_guard lock(mutex_);
    for (storage::RobotSetting& setting : settings) {
      Put(std::move(setting), changes);
    }
  }
  Tell(changes);
}

bool RobotSettings::Replace(std::vector<storage::RobotSetting> settings) {
  std::vector<Change> changes;
  {
    const std::lock_guard lock(mutex_);
    Table gone = std::move(decided_);
    gone.merge(noted_);
    decided_.clear();
    noted_.clear();
    left_out_ = 0;
    for (storage::RobotSetting& setting : settings) {
      Put(std::move(setting), changes);
    }
    for (Change& change : changes) {
      change.disconnect = false;
      if (const auto before = gone.find(change.ruri); before != gone.end()) {
        change.before = before->second;
        gone.erase(before);
      }
    }
    for (const auto& [ruri, setting] : gone) {
      changes.push_back({.ruri = ruri, .before = setting, .now = nullptr});
    }
  }
  std::erase_if(changes, ChangesNothing);
  Tell(changes);
  return !changes.empty();
}

void RobotSettings::Tell(std::span<const Change> changes) const {
  if (changed_ && !changes.empty()) {
    changed_(changes);
  }
}

}  // namespace uplink::fleet
