#include "server/journal/open_queue.h"

#include <algorithm>
#include <utility>

namespace uplink::journal {

bool OpenQueue::Push(OpenEntry entry) {
  const auto queued = std::ranges::find(queue_, entry.client, &OpenEntry::client);
  if (queued != queue_.end()) {
    *queued = std::move(entry);
    return false;
  }
  queue_.push_back(std::move(entry));
  unopened_.fetch_add(1);
  return true;
}

std::vector<OpenEntry> OpenQueue::MoveTo(std::vector<OpenEntry> taken, std::size_t most) {
  while (!queue_.empty() && taken.size() < most) {
    OpenEntry entry = std::move(queue_.front());
    queue_.pop_front();
    const auto earlier = std::ranges::find(taken, entry.client, &OpenEntry::client);
    if (earlier == taken.end()) {
      taken.push_back(std::move(entry));
    } else {
      *earlier = std::move(entry);
      unopened_.fetch_sub(1);
    }
  }
  return taken;
}

void OpenQueue::PutBack(std::vector<OpenEntry> taken) {
  while (!taken.empty()) {
    const auto newer = std::ranges::find(queue_, taken.back().client, &OpenEntry::client);
    if (newer == queue_.end()) {
      queue_.push_front(std::move(taken.back()));
    } else {
      unopened_.fetch_sub(1);
    }
    taken.pop_back();
  }
}

}  // namespace uplink::journal
