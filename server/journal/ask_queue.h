#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "server/robot/commit_client.h"
#include "storage/claim.h"
#include "storage/open_stream.h"

namespace uplink::journal {

/// A stream that waits to be opened.
struct OpenEntry {
  robot::ClientRef client;
  std::uint64_t open_id = 0;
  storage::OpenRequest request;
  /// As Moved::gateway.
  std::string gateway = {};
};

/// A drone that waits to be claimed.
struct ClaimEntry {
  robot::ClientRef client;
  /// Its robot's client.
  robot::ClientRef robot;
  storage::ClaimRequest request;
  /// As Moved::gateway.
  std::string gateway = {};
};

/// Unanswered requests to the store, in order: at most one per client, the newest.
///
/// Limits: one entry per robot in memory (limits.robots_max, and fleet::kLeavingMax).
/// Thread: confined to its owner's lock; unanswered() and CountAnswered: any thread.
template <typename Entry>
class AskQueue final {
 public:
  /// False if it replaced a waiting one of the same client.
  bool Push(Entry entry) {
    const auto queued = std::ranges::find(queue_, entry.client, &Entry::client);
    if (queued != queue_.end()) {
      *queued = std::move(entry);
      return false;
    }
    queue_.push_back(std::move(entry));
    unanswered_.fetch_add(1);
    return true;
  }

  /// Moves entries from the front to the end of `taken` until that holds `most`. An entry whose
  /// client is in `taken` already replaces that one.
  [[nodiscard]] std::vector<Entry> MoveTo(std::vector<Entry> taken, std::size_t most) {
    while (!queue_.empty() && taken.size() < most) {
      Entry entry = std::move(queue_.front());
      queue_.pop_front();
      const auto earlier = std::ranges::find(taken, entry.client, &Entry::client);
      if (earlier == taken.end()) {
        taken.push_back(std::move(entry));
      } else {
        *earlier = std::move(entry);
        unanswered_.fetch_sub(1);
      }
    }
    return taken;
  }

  /// Puts taken entries back to the front, in order. A waiting newer entry of the same client
  /// replaces the older one.
  void PutBack(std::vector<Entry> taken) {
    while (!taken.empty()) {
      const auto newer = std::ranges::find(queue_, taken.back().client, &Entry::client);
      if (newer == queue_.end()) {
        queue_.push_front(std::move(taken.back()));
      } else {
        unanswered_.fetch_sub(1);
      }
      taken.pop_back();
    }
  }

  /// So many taken entries are answered.
  void CountAnswered(std::size_t count) { unanswered_.fetch_sub(count); }

  /// None waits to be taken.
  [[nodiscard]] bool empty() const { return queue_.empty(); }
  /// Entries that wait, and taken ones without an answer.
  [[nodiscard]] std::size_t unanswered() const { return unanswered_.load(); }

 private:
  std::deque<Entry> queue_;
  std::atomic<std::size_t> unanswered_{0};
};

using OpenQueue = AskQueue<OpenEntry>;
using ClaimQueue = AskQueue<ClaimEntry>;

}  // namespace uplink::journal
