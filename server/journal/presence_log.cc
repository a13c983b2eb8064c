#include "server/journal/presence_log.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace uplink::journal {

void PresenceLog::Hold(const std::string& ruri, storage::Epoch since,
                       const std::optional<storage::StoredPresence>& stored) {
  held_[ruri] = since;
  if (stored) handed_[ruri] = *stored;
}

void PresenceLog::Lose(const std::string& ruri) {
  held_.erase(ruri);
  handed_.erase(ruri);
  uncommitted_.fetch_sub(waiting_.erase(ruri));
  uncommitted_.fetch_sub(std::erase_if(
      put_back_, [&](const storage::PresenceItem& item) { return item.robot->ruri == ruri; }));
}

bool PresenceLog::Follow(const storage::RobotRef& robot,
                         const std::optional<storage::StoredPresence>& stored, Reconnected to) {
  const auto handed = handed_.find(robot->ruri);
  const auto held = held_.find(robot->ruri);
  if (handed == handed_.end() || held == held_.end()) return false;
  const auto put_back = std::ranges::find_if(put_back_, [&](const storage::PresenceItem& item) {
    return item.robot->ruri == robot->ruri;
  });
  if (put_back != put_back_.end()) return FollowPutBack(put_back, stored, to);
  if (stored && stored->presence == handed->second.presence) return false;
  const storage::StoredPresence told = handed->second;
  handed_.erase(handed);
  if (stored) handed_[robot->ruri] = *stored;
  const auto waits = waiting_.find(robot->ruri);
  if (waits == waiting_.end()) {
    Note(robot, told.presence, told.since);
  } else {
    Note(robot, waits->second.presence, waits->second.at, waits->second.why);
  }
  return true;
}

bool PresenceLog::FollowPutBack(std::vector<storage::PresenceItem>::iterator put_back,
                                const std::optional<storage::StoredPresence>& stored,
                                Reconnected to) {
  const bool same = stored && stored->presence == put_back->presence;
  // It was committed, and the answer was lost.
  if (same && UnixMs(stored->since) == UnixMs(put_back->at)) return false;
  // The change that was handed over is what the same server will have.
  if (!same && to == Reconnected::kSameServer) return false;
  const storage::PresenceItem item = std::move(*put_back);
  put_back_.erase(put_back);
  uncommitted_.fetch_sub(1);
  handed_.erase(item.robot->ruri);
  if (stored) handed_[item.robot->ruri] = *stored;
  // The store has that presence since an earlier time, and what came between is lost: no change.
  if (same) return true;
  // A later change may be none any more.
  const auto waits = waiting_.find(item.robot->ruri);
  const storage::PresenceItem last = waits == waiting_.end() ? item : waits->second;
  Note(last.robot, last.presence, last.at, last.why);
  return false;
}

void PresenceLog::Note(const storage::RobotRef& robot, model::Presence presence, SystemTime at,
                       std::optional<model::ConnectionEnd> why) {
  const auto held = held_.find(robot->ruri);
  if (held == held_.end()) return;
  const auto handed = handed_.find(robot->ruri);
  if (handed != handed_.end() && handed->second.presence == presence) {
    uncommitted_.fetch_sub(waiting_.erase(robot->ruri));
    return;
  }
  if (handed != handed_.end()) at = std::max(at, handed->second.since);
  const auto [item, first] = waiting_.insert_or_assign(
      robot->ruri, storage::PresenceItem{robot, presence, at, 0, held->second, why});
  if (first) uncommitted_.fetch_add(1);
}

std::vector<storage::PresenceItem> PresenceLog::Take(std::size_t items_max) {
  std::vector<storage::PresenceItem> items;
  if (!put_back_.empty()) {
    const auto end =
        put_back_.begin() + static_cast<std::ptrdiff_t>(std::min(put_back_.size(), items_max));
    items.assign(put_back_.begin(), end);
    put_back_.erase(put_back_.begin(), end);
    return items;
  }
  items.reserve(std::min(items_max, waiting_.size()));
  while (!waiting_.empty() && items.size() < items_max) {
    auto first = waiting_.extract(waiting_.begin());
    first.mapped().number = ++last_number_;
    handed_[first.key()] = {first.mapped().presence, first.mapped().at};
    items.push_back(std::move(first.mapped()));
  }
  return items;
}

bool PresenceLog::waits(const std::string& ruri) const {
  return waiting_.contains(ruri) ||
         std::ranges::any_of(put_back_, [&](const storage::PresenceItem& item) {
           return item.robot->ruri == ruri;
         });
}

void PresenceLog::PutBack(std::vector<storage::PresenceItem> items) {
  put_back_.insert(put_back_.begin(), std::make_move_iterator(items.begin()),
                   std::make_move_iterator(items.end()));
}

}  // namespace uplink::journal
