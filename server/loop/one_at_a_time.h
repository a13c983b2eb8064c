#pragma once

#include <atomic>
#include <functional>
#include <utility>

namespace uplink::loop {

/// Gives a job to another thread. False if that thread takes no job now.
using Post = std::function<bool(std::function<void()>)>;

/// A repeated job that another thread does: at most one waits there or is under way.
///
/// Thread: thread-safe; it outlives the job.
class OneAtATime final {
 public:
  /// Posts the job, unless the last one is not done or the thread takes none now. The caller calls
  /// this repeatedly.
  void PostBy(const Post& post, std::function<void()> job) {
    if (posted_.exchange(true)) return;
    const bool taken = post([this, job = std::move(job)] {
      job();
      posted_.store(false);
    });
    if (!taken) posted_.store(false);
  }

 private:
  std::atomic<bool> posted_{false};
};

}  // namespace uplink::loop
