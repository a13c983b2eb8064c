#include "server/log/standard_error.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include <pthread.h>
#include <sys/eventfd.h>

#include "schema/base/check.h"
#include "schema/base/write_all.h"
#include "server/log/line_text.h"

namespace uplink::log {
namespace {

class StandardErrorSink final : public LineSink {
 public:
  StandardErrorSink(const Clock& clock, const StandardErrorOptions& options)
      : clock_(clock),
        options_(options),
        queue_(options.limits),
        stop_(eventfd(0, EFD_CLOEXEC)),
        thread_([this] { Run(); }) {
    pthread_setname_np(thread_.native_handle(), "log");
  }
  ~StandardErrorSink() override {
    queue_.Close();
    queue_.WaitUntilWritten(kFlushWait);
    // The remaining lines have no reader.
    eventfd_write(stop_, 1);
    thread_.join();
    close(stop_);
  }
  StandardErrorSink(const StandardErrorSink&) = delete;
  StandardErrorSink& operator=(const StandardErrorSink&) = delete;

  void Write(Level level, std::string_view line) override { queue_.Push(Whole(level, line)); }
  void Flush(milliseconds wait) override { queue_.WaitUntilWritten(wait); }
  [[nodiscard]] LineCounts counts() const override { return queue_.counts(); }

 private:
  [[nodiscard]] std::string Whole(Level level, std::string_view line) const {
    std::string whole(options_.priorities ? PriorityOf(level) : "");
    return whole.append(line).append("\n");
  }

  void Run() {
    while (const std::optional<LineQueue::Taken> taken = queue_.Take()) {
      for (const std::string& line : taken->lines) {
        TellLost();
        if (Put(line)) continue;
        queue_.NoteUnwritten();
        ++lost_;
      }
      lost_ += taken->lost;
      TellLost();
    }
  }

  /// Writes how many lines were lost since it last succeeded.
  void TellLost() {
    if (lost_ == 0) return;
    const Field lines("lines", lost_);
    const std::string line = LineText(options_.format, Level::kWarn, "log_lines_lost",
                                      std::span(&lines, 1), clock_.System());
    if (Put(Whole(Level::kWarn, line))) lost_ = 0;
  }

  bool Put(std::string_view text) {
    const WriteWait wait{.room = std::nullopt, .stop = stop_};
    return WriteAll(options_.descriptor, text, wait) == Written::kAll;
  }

  const Clock& clock_;
  const StandardErrorOptions options_;
  LineQueue queue_;
  /// Readable once the thread has to end. -1 if the process had no descriptor left: then only the
  /// reader ends a write that blocks.
  const int stop_;
  /// Lines that were lost and are not reported yet. The thread's.
  std::uint64_t lost_ = 0;
  std::jthread thread_;
};

}  // namespace

std::string_view PriorityOf(Level level) {
  switch (level) {
    case Level::kDebug:
      return "<7>";
    case Level::kInfo:
      return "<6>";
    case Level::kWarn:
      return "<4>";
    case Level::kError:
      return "<3>";
  }
  CheckFailed(__FILE__, __LINE__, "level", "a log level that does not exist");
}

std::unique_ptr<LineSink> StandardError(const Clock& clock, const StandardErrorOptions& options) {
  return std::make_unique<StandardErrorSink>(clock, options);
}

}  // namespace uplink::log
