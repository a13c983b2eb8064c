#include "storage/sqlite/wal_index.h"

#include <cstddef>

#include <sqlite3.h>

#include "storage/sqlite/open_files.h"

namespace uplink::storage::sqlite {
namespace {

/// The first part of the index, as every connection maps it.
constexpr int kIndexBytes = 32 * 1024;
constexpr std::size_t kMovedWord = 24;
constexpr std::size_t kMovingWord = 32;

}  // namespace

absl::StatusOr<std::optional<WalIndex>> ReadWalIndex(const Database& database) {
  const absl::StatusOr<sqlite3_file*> file = OpenDatabaseFile(database);
  if (!file.ok()) return file.status();
  volatile void* mapped = nullptr;
  const int code = (*file)->pMethods->xShmMap(*file, 0, kIndexBytes, 0, &mapped);
  if (code != SQLITE_OK) return database.Error(code, "map the index of the WAL");
  if (mapped == nullptr) return std::optional<WalIndex>();
  const auto* words = static_cast<const volatile std::uint32_t*>(mapped);
  WalIndex index;
  std::array<std::uint32_t, 12> second{};
  // A connection that writes the header writes the second copy first.
  for (std::size_t i = 0; i < index.header.size(); ++i) index.header[i] = words[i];
  (*file)->pMethods->xShmBarrier(*file);
  for (std::size_t i = 0; i < second.size(); ++i) second[i] = words[second.size() + i];
  index.moved = words[kMovedWord];
  index.moving = words[kMovingWord];
  (*file)->pMethods->xShmBarrier(*file);
  return second == index.header ? std::optional(index) : std::nullopt;
}

}  // namespace uplink::storage::sqlite
