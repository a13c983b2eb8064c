#pragma once

#include <mutex>
#include <utility>

#include "storage/access_store.h"

namespace uplink::admin {

/// What operators decide, for several threads: the calls of the store go one by one, each on the
/// thread that asks.
///
/// Thread: thread-safe. The store outlives it, and nothing else calls that.
class SharedStore final {
 public:
  explicit SharedStore(storage::AccessStore& store) : store_(store) {}
  SharedStore(const SharedStore&) = delete;
  SharedStore& operator=(const SharedStore&) = delete;

  /// What `call` returns, which gets the AccessStore. It waits for the store.
  template <typename Call>
  [[nodiscard]] auto With(Call&& call) {
    const std::lock_guard lock(mutex_);
    return std::forward<Call>(call)(store_);
  }

 private:
  std::mutex mutex_;
  storage::AccessStore& store_;
};

}  // namespace uplink::admin
