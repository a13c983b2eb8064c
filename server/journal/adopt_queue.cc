#include "server/journal/adopt_queue.h"

#include <utility>

namespace uplink::journal {

milliseconds AdoptGrace::Of(storage::HolderEnd end) const {
  switch (end) {
    case storage::HolderEnd::kEnded:
      return ended;
    case storage::HolderEnd::kSilent:
      break;
  }
  return silent;
}

bool AdoptQueue::Push(AdoptEntry entry) {
  if (!adopting_.insert(entry.client.get()).second) return false;
  adopts_.push_back(std::move(entry));
  return true;
}

bool AdoptQueue::Push(LossEntry entry) {
  if (!lost_.insert(entry.client.get()).second) return false;
  losses_.push_back(std::move(entry));
  return true;
}

bool AdoptQueue::Push(LeaveEntry entry) {
  if (!leaving_.insert(entry.client.get()).second) return false;
  leaves_.push_back(std::move(entry));
  return true;
}

std::vector<AdoptEntry> AdoptQueue::TakeAdopts(std::size_t most) {
  std::vector<AdoptEntry> taken;
  while (!adopts_.empty() && taken.size() < most) {
    adopting_.erase(adopts_.front().client.get());
    taken.push_back(std::move(adopts_.front()));
    adopts_.pop_front();
  }
  return taken;
}

std::vector<LossEntry> AdoptQueue::TakeLosses() {
  lost_.clear();
  return std::exchange(losses_, {});
}

std::vector<LeaveEntry> AdoptQueue::TakeLeaves() {
  leaving_.clear();
  return std::exchange(leaves_, {});
}

}  // namespace uplink::journal
