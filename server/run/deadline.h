#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "schema/base/clock.h"

namespace uplink::run {

/// Runs `late`, on a thread of its own, if this object still exists after `wait`.
class Deadline final {
 public:
  Deadline(milliseconds wait, std::function<void()> late);
  ~Deadline();
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable_any over_;
  std::jthread thread_;
};

}  // namespace uplink::run
