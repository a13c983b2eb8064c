#include "server/journal/presence_log.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace uplink::journal {
namespace {

/// Since when is left out: it may be what a former holder wrote by another clock.
bool Same(const storage::StoredPresence& one, const storage::StoredPresence& other) {
  return one.presence == other.presence && one.parked_until == other.parked_until;
}

}  // namespace

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
  if (stored && Same(*stored, handed->second)) return false;
  const storage::StoredPresence told = handed->second;
  handed_.erase(handed);
  if (stored) handed_[robot->ruri] = *stored;
  const auto waits = waiting_.find(robot->ruri);
  if (waits == waiting_.end()) {
    Note(robot, told.presence, told.since, {}, told.parked_until);
  } else {
    const storage::PresenceItem item = waits->second;
    Note(robot, item.presence, item.at, item.why, item.parked_until);
  }
  return true;
}

bool PresenceLog::FollowPutBack(std::vector<storage::PresenceItem>::iterator put_back,
                                const std::optional<storage::StoredPresence>& stored,
                                Reconnected to) {
  const bool same =
      stored && Same(*stored, {put_back->presence, put_back->at, put_back->parked_until});
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
  Note(last.robot, last.presence, last.at, last.why, last.parked_until);
  return false;
}

void PresenceLog::Note(const storage::RobotRef& robot, model::Presence presence, SystemTime at,
                       std::optional<model::ConnectionEnd> why,
                       std::optional<SystemTime> parked_until) {
  const auto held = held_.find(robot->ruri);
  if (held == held_.end()) return;
  const auto found = handed_.find(robot->ruri);
  // A robot that was never reported is unknown.
  const storage::StoredPresence handed =
      found == handed_.end() ? storage::StoredPresence{.since = at} : found->second;
  const bool changes = presence != handed.presence || (found == handed_.end() && !parked_until);
  if (!changes && handed.parked_until == parked_until) {
    uncommitted_.fetch_sub(waiting_.erase(robot->ruri));
    return;
  }
  at = changes ? std::max(at, handed.since) : handed.since;
  // Why it went offline is said with the change alone.
  const auto waits = waiting_.find(robot->ruri);
  if (!why && waits != waiting_.end() && waits->second.presence == presence) {
    why = waits->second.why;
  }
  const auto [item, first] = waiting_.insert_or_assign(
      robot->ruri,
      storage::PresenceItem{robot, presence, at, 0, held->second, why, parked_until, changes});
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
    const storage::PresenceItem& item = first.mapped();
    handed_[first.key()] = {item.presence, item.at, item.parked_until};
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
