#include "storage/sqlite/wal_state.h"

#include <algorithm>
#include <chrono>

#include "storage/sqlite/open_files.h"

namespace uplink::storage::sqlite {
namespace {

std::uint64_t AtLeastZero(std::int64_t bytes) {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(bytes, 0));
}

}  // namespace

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
