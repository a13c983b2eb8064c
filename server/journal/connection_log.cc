#include "server/journal/connection_log.h"

#include <algorithm>
#include <iterator>

namespace uplink::journal {

bool ConnectionLog::HasRoomFor(const storage::ConnectionItem& item) const {
  if (uncommitted_.load() >= connections_max_) return false;
  const auto share = shares_.find(item.gateway);
  return share == shares_.end() || share->second < connections_max_ / 2;
}

void ConnectionLog::CountIn(const storage::ConnectionItem& item) {
  if (!item.gateway.empty()) ++shares_[item.gateway];
}

void ConnectionLog::CountOut(const storage::ConnectionItem& item) {
  const auto share = shares_.find(item.gateway);
  if (share != shares_.end() && --share->second == 0) shares_.erase(share);
}

bool ConnectionLog::Note(storage::ConnectionItem item) {
  const auto known = places_.find(KeyOf(item));
  if (known != places_.end()) {
    storage::ConnectionItem& waiting = *known->second;
    if (!storage::Replaces(item, waiting)) return true;
    // The key's view is of this one.
    item.robot = waiting.robot;
    waiting = std::move(item);
    return true;
  }
  if (!HasRoomFor(item)) return false;
  CountIn(item);
  waiting_.push_back(std::move(item));
  places_.emplace(KeyOf(waiting_.back()), std::prev(waiting_.end()));
  uncommitted_.fetch_add(1);
  return true;
}

std::vector<storage::ConnectionItem> ConnectionLog::Take(std::size_t items_max) {
  std::vector<storage::ConnectionItem> items;
  items.reserve(std::min(items_max, waiting_.size()));
  while (!waiting_.empty() && items.size() < items_max) {
    places_.erase(KeyOf(waiting_.front()));
    CountOut(waiting_.front());
    items.push_back(std::move(waiting_.front()));
    waiting_.pop_front();
  }
  return items;
}

void ConnectionLog::PutBack(std::vector<storage::ConnectionItem> items) {
  for (auto item = items.rbegin(); item != items.rend(); ++item) {
    const auto known = places_.find(KeyOf(*item));
    if (known != places_.end()) {
      storage::ConnectionItem& waiting = *known->second;
      if (!storage::Replaces(waiting, *item)) {
        item->robot = waiting.robot;
        waiting = std::move(*item);
      }
      uncommitted_.fetch_sub(1);
      continue;
    }
    CountIn(*item);
    waiting_.push_front(std::move(*item));
    places_.emplace(KeyOf(waiting_.front()), waiting_.begin());
  }
}

}  // namespace uplink::journal
