#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <absl/status/status.h>

#include "storage/sqlite/database.h"
#include "storage/sqlite/reader.h"

namespace uplink::storage::sqlite {

/// The connections of a reader that no read uses now. Thread-safe.
class SqliteReader::Pool final {
 public:
  Pool(std::string path, const ReaderOptions& options)
      : path_(std::move(path)), options_(options) {}

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Opens them all; what fails names the path.
  [[nodiscard]] absl::Status Fill();

  /// Runs `read` with a connection; waits for one.
  template <typename Read>
  auto With(const Read& read) -> decltype(read(std::declval<Database&>())) {
    std::unique_ptr<Database> database;
    {
      std::unique_lock lock(mutex_);
      if (!returned_.wait_for(lock, options_.wait_max, [this] { return !free_.empty(); })) {
        return absl::UnavailableError("all reading connections of " + path_ + " are in use");
      }
      database = std::move(free_.back());
      free_.pop_back();
    }
    database->LimitSteps(options_.steps_max);
    auto result = read(*database);
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(database));
    returned_.notify_one();
    return result;
  }

 private:
  const std::string path_;
  const ReaderOptions options_;
  std::mutex mutex_;
  std::condition_variable returned_;
  std::vector<std::unique_ptr<Database>> free_;
};

}  // namespace uplink::storage::sqlite
