#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <utility>

#include "server/session/reject_source.h"
#include "storage/reader.h"

namespace uplink::testing {

/// Reads from a reader when it is told to; or at once, on the thread that asks. Thread-safe.
class FakeRejectSource final : public session::RejectSource {
 public:
  enum class Reads : std::uint8_t { kAtOnce, kWhenTold };

  /// `reader` outlives it; null: every read fails.
  explicit FakeRejectSource(storage::Reader* reader, Reads reads = Reads::kAtOnce)
      : reader_(reader), reads_(reads) {}

  [[nodiscard]] bool Read(const storage::RejectsQuery& query, Done done) override {
    std::function<void()> job = [this, query, done = std::move(done)] {
      if (Fails()) return done(absl::UnavailableError("the reader is away"));
      done(reader_->Rejects(query));
    };
    if (reads_ == Reads::kAtOnce) {
      job();
      return true;
    }
    const std::lock_guard lock(mutex_);
    if (full_) return false;
    jobs_.push_back(std::move(job));
    return true;
  }

  /// Reads of now on fail; Read takes none.
  void SetAway(bool away) {
    const std::lock_guard lock(mutex_);
    away_ = away;
  }
  void SetFull(bool full) {
    const std::lock_guard lock(mutex_);
    full_ = full;
  }
  /// Reads that wait.
  [[nodiscard]] std::size_t waiting() const {
    const std::lock_guard lock(mutex_);
    return jobs_.size();
  }
  /// Does the read that waits for longest. False if none waits.
  bool ReadOne() {
    std::function<void()> job;
    {
      const std::lock_guard lock(mutex_);
      if (jobs_.empty()) return false;
      job = std::move(jobs_.front());
      jobs_.pop_front();
    }
    job();
    return true;
  }

 private:
  [[nodiscard]] bool Fails() const {
    const std::lock_guard lock(mutex_);
    return away_ || reader_ == nullptr;
  }

  storage::Reader* const reader_;
  const Reads reads_;
  mutable std::mutex mutex_;
  bool away_ = false;
  bool full_ = false;
  std::deque<std::function<void()>> jobs_;
};

}  // namespace uplink::testing
