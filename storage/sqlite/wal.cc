#include "storage/sqlite/wal.h"

#include <algorithm>
#include <chrono>
#include <cstddef>

#include <absl/status/status.h>
#include <sqlite3.h>

namespace uplink::storage::sqlite {
namespace {

absl::StatusOr<sqlite3_file*> FileOf(const Database& database, int which) {
  sqlite3_file* file = nullptr;
  const int code = sqlite3_file_control(database.handle(), "main", which, &file);
  if (code != SQLITE_OK) return database.Error(code, "find an open file");
  if (file == nullptr || file->pMethods == nullptr) {
    return absl::UnavailableError("sqlite " + database.path() + ": a file is not open");
  }
  return file;
}

/// The first part of the index, as every connection maps it.
constexpr int kIndexBytes = 32 * 1024;
constexpr std::size_t kMovedWord = 24;
constexpr std::size_t kMovingWord = 32;

std::uint64_t AtLeastZero(std::int64_t bytes) {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(bytes, 0));
}

}  // namespace

absl::StatusOr<sqlite3_file*> OpenDatabaseFile(const Database& database) {
  return FileOf(database, SQLITE_FCNTL_FILE_POINTER);
}

absl::StatusOr<sqlite3_file*> OpenWalFile(const Database& database) {
  return FileOf(database, SQLITE_FCNTL_JOURNAL_POINTER);
}

absl::StatusOr<std::int64_t> SizeOf(const Database& database, sqlite3_file* file) {
  sqlite3_int64 bytes = 0;
  const int code = file->pMethods->xFileSize(file, &bytes);
  if (code != SQLITE_OK) return database.Error(code, "look at the size of a file");
  return bytes;
}

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

WalState WalStateOf(const WalIndex& index, const WalSizes& sizes) {
  WalState state;
  state.bytes = AtLeastZero(sizes.wal);
  state.salts = index.salts();
  state.moved = index.moved;
  if (index.moved >= index.last_frame()) {
    state.reusable_bytes = state.bytes;
    return state;
  }
  state.unmoved = index.last_frame() - index.moved;
  state.reusable_bytes = AtLeastZero(sizes.wal - EndOfFrame(index.last_frame(), sizes.page));
  state.owed_bytes = AtLeastZero(std::int64_t{index.pages()} * sizes.page - sizes.database);
  return state;
}

absl::StatusOr<std::optional<WalState>> ReadWalState(Database& database) {
  const absl::StatusOr<std::optional<WalIndex>> index = ReadWalIndex(database);
  if (!index.ok()) return index.status();
  if (!*index) return std::optional<WalState>();
  const absl::StatusOr<sqlite3_file*> wal = OpenWalFile(database);
  if (!wal.ok()) return wal.status();
  const absl::StatusOr<std::int64_t> wal_bytes = SizeOf(database, *wal);
  if (!wal_bytes.ok()) return wal_bytes.status();
  const absl::StatusOr<sqlite3_file*> file = OpenDatabaseFile(database);
  if (!file.ok()) return file.status();
  const absl::StatusOr<std::int64_t> bytes = SizeOf(database, *file);
  if (!bytes.ok()) return bytes.status();
  const absl::StatusOr<std::int64_t> page = database.ReadInt("PRAGMA page_size");
  if (!page.ok()) return page.status();
  return WalStateOf(**index, {*wal_bytes, *bytes, *page});
}

milliseconds WalHoldAge::Note(const WalState& state, SteadyTime now) {
  if (!state.held()) {
    held_.reset();
    return milliseconds(0);
  }
  if (!held_ || held_->salts != state.salts || held_->moved != state.moved) {
    held_ = {state.salts, state.moved, now};
  }
  return std::chrono::duration_cast<milliseconds>(now - held_->since);
}

}  // namespace uplink::storage::sqlite
