#include "server/log/line_queue.h"

#include <utility>

namespace uplink::log {

void LineQueue::Push(std::string line) {
  {
    const std::lock_guard lock(mutex_);
    const bool fits =
        Waiting() < limits_.lines_max && bytes_ + taken_bytes_ + line.size() <= limits_.bytes_max;
    if (closed_ || !fits) {
      ++lost_;
      ++dropped_total_;
      return;
    }
    ++pushed_total_;
    bytes_ += line.size();
    lines_.push_back(std::move(line));
  }
  pushed_.notify_one();
}

std::optional<LineQueue::Taken> LineQueue::Take() {
  std::unique_lock lock(mutex_);
  written_total_ += std::exchange(taken_lines_, 0);
  taken_bytes_ = 0;
  written_.notify_all();
  pushed_.wait(lock, [this] { return !lines_.empty() || lost_ > 0 || closed_; });
  if (lines_.empty() && lost_ == 0) return std::nullopt;
  // All at once: lines dropped from here on come after what was taken and before what comes next.
  Taken taken{std::exchange(lines_, {}), std::exchange(lost_, 0)};
  taken_lines_ = taken.lines.size();
  taken_bytes_ = std::exchange(bytes_, 0);
  return taken;
}

void LineQueue::NoteUnwritten() {
  const std::lock_guard lock(mutex_);
  ++dropped_total_;
}

void LineQueue::Close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  pushed_.notify_all();
}

void LineQueue::WaitUntilWritten(milliseconds wait) {
  std::unique_lock lock(mutex_);
  const std::uint64_t until = pushed_total_;
  written_.wait_for(lock, wait, [&] { return written_total_ >= until; });
}

LineCounts LineQueue::counts() const {
  const std::lock_guard lock(mutex_);
  return {Waiting(), dropped_total_};
}

}  // namespace uplink::log
