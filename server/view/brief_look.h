#pragma once

#include <chrono>
#include <functional>
#include <memory>

#include "schema/base/clock.h"

namespace uplink::view {

/// How long an answer from memory waits for what the store could add to it.
inline constexpr std::chrono::milliseconds kBriefLookWait{250};

/// Looks into the store for callers that may wait only a moment. The look runs on a thread that may
/// wait for the store. While one look takes longer than the wait, further ones fail at once.
///
/// Thread: thread-safe. A look that is under way may outlive this object.
class BriefLook final {
 public:
  /// Posts a job to the thread that may wait; false if that takes none now. Empty: the look runs at
  /// once, on the caller's thread.
  using Post = std::function<bool(std::function<void()>)>;
  explicit BriefLook(Post post, milliseconds wait = kBriefLookWait);
  BriefLook(const BriefLook&) = delete;
  BriefLook& operator=(const BriefLook&) = delete;

  /// Runs `look`, which owns what it touches; true if it ended in time.
  [[nodiscard]] bool Run(std::function<void()> look);

 private:
  struct State;
  const Post post_;
  const milliseconds wait_;
  const std::shared_ptr<State> state_;
};

}  // namespace uplink::view
