#include "storage/sqlite/reader_pool.h"

#include "storage/sqlite/open_beside.h"

namespace uplink::storage::sqlite {

absl::Status SqliteReader::Pool::Fill() {
  for (std::size_t i = 0; i < options_.connections; ++i) {
    auto database = OpenToRead(path_, options_.wait_max, options_.damage);
    if (!database.ok()) return database.status();
    free_.push_back(*std::move(database));
  }
  return absl::OkStatus();
}

}  // namespace uplink::storage::sqlite
