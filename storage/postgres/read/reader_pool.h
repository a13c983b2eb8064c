#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include <absl/status/status.h>

#include "storage/postgres/link/link.h"
#include "storage/postgres/reader.h"

namespace uplink::storage::postgres {

/// The connections of a reader that no read uses now. Thread-safe.
class PostgresReader::Pool final {
 public:
  Pool(const ReaderOptions& options, const Link::Options& link, const Clock& clock);

  [[nodiscard]] const Clock& clock() const { return clock_; }
  /// Runs `read` with a connection; waits for one. Once more, with a new one, if that had died
  /// while nobody used it.
  template <typename Read>
  auto With(const Read& read) -> decltype(read(std::declval<Connection&>())) {
    std::unique_ptr<Link> link;
    {
      std::unique_lock lock(mutex_);
      if (failed_until_ && clock_.Steady() < *failed_until_) return failure_;
      if (!returned_.wait_for(lock, options_.wait_max, [this] { return !free_.empty(); })) {
        return absl::UnavailableError("all reading connections of the store are in use");
      }
      link = std::move(free_.back());
      free_.pop_back();
    }
    auto result = ReadAgainIfDied(*link, [&] { return Try(*link, read); });
    Return(std::move(link));
    return result;
  }

 private:
  template <typename Read>
  auto Try(Link& link, const Read& read) -> decltype(read(std::declval<Connection&>())) {
    const absl::StatusOr<Connection*> connection = link.Get();
    if (!connection.ok()) {
      NoteFailure(connection.status());
      return connection.status();
    }
    return read(**connection);
  }
  void NoteFailure(const absl::Status& status);
  void Return(std::unique_ptr<Link> link);

  const ReaderOptions options_;
  const Clock& clock_;
  std::mutex mutex_;
  std::condition_variable returned_;
  std::vector<std::unique_ptr<Link>> free_;
  absl::Status failure_;
  std::optional<SteadyTime> failed_until_;
};

}  // namespace uplink::storage::postgres
