#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <utility>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/loop/one_at_a_time.h"

namespace uplink::store {

/// How long another program has kept the store from cleaning up; asked repeatedly.
///
/// Thread: AskOn on one; age from any.
class OldestSnapshot final {
 public:
  /// `ask` may wait; one job at a time calls it. If it is empty, the age is zero.
  using Ask = std::function<absl::StatusOr<milliseconds>()>;
  explicit OldestSnapshot(Ask ask) : ask_(std::move(ask)) {}
  OldestSnapshot(const OldestSnapshot&) = delete;
  OldestSnapshot& operator=(const OldestSnapshot&) = delete;

  /// Posts the question to a thread that may wait, unless one is under way. While the store does
  /// not answer, the last answer stays.
  void AskOn(const loop::Post& post) {
    if (!ask_) return;
    asks_.PostBy(post, [this] {
      if (const absl::StatusOr<milliseconds> age = ask_(); age.ok()) age_ms_.store(age->count());
    });
  }
  [[nodiscard]] milliseconds age() const { return milliseconds(age_ms_.load()); }

 private:
  const Ask ask_;
  loop::OneAtATime asks_;
  std::atomic<std::int64_t> age_ms_{0};
};

}  // namespace uplink::store
