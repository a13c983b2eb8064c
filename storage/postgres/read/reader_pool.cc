#include "storage/postgres/read/reader_pool.h"

namespace uplink::storage::postgres {

PostgresReader::Pool::Pool(const ReaderOptions& options, const Link::Options& link,
                           const Clock& clock)
    : options_(options), clock_(clock) {
  for (std::size_t i = 0; i < options.connections; ++i) {
    free_.push_back(std::make_unique<Link>(link, clock));
  }
}

void PostgresReader::Pool::NoteFailure(const absl::Status& status) {
  const std::lock_guard lock(mutex_);
  failure_ = status;
  failed_until_ = clock_.Steady() + options_.retry_pause;
}

void PostgresReader::Pool::Return(std::unique_ptr<Link> link) {
  const std::lock_guard lock(mutex_);
  free_.push_back(std::move(link));
  returned_.notify_one();
}

}  // namespace uplink::storage::postgres
