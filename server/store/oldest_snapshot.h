#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <utility>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"

namespace uplink::store {

/// How long something else has kept the store from cleaning up, asked for again and again.
///
/// Thread: AskOn on one; age from any.
class OldestSnapshot final {
 public:
  /// `ask` may wait; it is called by one job at a time. Where there is none, the age is zero.
  using Ask = std::function<absl::StatusOr<milliseconds>()>;
  explicit OldestSnapshot(Ask ask) : ask_(std::move(ask)) {}
  OldestSnapshot(const OldestSnapshot&) = delete;
  OldestSnapshot& operator=(const OldestSnapshot&) = delete;

  /// Asks by a job on a thread that may wait, unless one is under way. `post` is false where it
  /// takes no job now. While the store does not answer, the last answer stays.
  void AskOn(const std::function<bool(std::function<void()>)>& post);
  [[nodiscard]] milliseconds age() const { return milliseconds(age_ms_.load()); }

 private:
  const Ask ask_;
  std::atomic<bool> asking_{false};
  std::atomic<std::int64_t> age_ms_{0};
};

}  // namespace uplink::store
