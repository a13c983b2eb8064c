#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/wal_index.h"

namespace uplink::storage::sqlite {

/// Frames of the WAL from which on a commit moves them into the database: SQLite's own default.
inline constexpr std::uint32_t kMovedAtFrames = 1'000;
/// A WAL that nothing holds has about this length, in bytes: kMovedAtFrames with pages of 4 KiB. A
/// longer one is large.
inline constexpr std::uint64_t kWalLargeBytes = std::uint64_t{4} << 20;

/// What the WAL takes of its disk, gives back and still needs. A value.
struct WalState {
  /// Of its file.
  std::uint64_t bytes = 0;
  /// Of these: what the next commits write over, since a checkpoint has moved all of it, or no
  /// commit reached so far.
  std::uint64_t reusable_bytes = 0;
  /// By how much the database grows once all of the WAL is moved into it.
  std::uint64_t owed_bytes = 0;
  /// Frames that were moved into the database, and those that are left.
  std::uint32_t moved = 0;
  std::uint32_t unmoved = 0;
  /// As in WalIndex.
  std::array<std::uint32_t, 2> salts{};

  /// A commit moves so many, unless a connection reads a state from before them, or the disk is
  /// full.
  [[nodiscard]] bool held() const { return unmoved >= kMovedAtFrames; }
};

/// The sizes of the files and of a page, in bytes, as SQLite has them.
struct WalSizes {
  std::int64_t wal = 0;
  std::int64_t database = 0;
  std::int64_t page = 0;
};

/// A pure function.
[[nodiscard]] WalState WalStateOf(const WalIndex& index, const WalSizes& sizes);

/// Of a connection that has read from the database. Nothing while another connection writes the
/// index.
///
/// Errors: kUnavailable if a file cannot be asked.
[[nodiscard]] absl::StatusOr<std::optional<WalState>> ReadWalState(Database& database);

/// How long a reader has kept the WAL from being moved into the database, by states that were read
/// one after the other. Confined to one thread at a time.
class WalHoldAge final {
 public:
  /// The age as of `now`, in steps of how often this is called: since the first of the states that
  /// are held at the same frame.
  milliseconds Note(const WalState& state, SteadyTime now);

 private:
  /// Where frames are left, and since when.
  struct Held {
    std::array<std::uint32_t, 2> salts{};
    std::uint32_t moved = 0;
    SteadyTime since;
  };
  std::optional<Held> held_;
};

}  // namespace uplink::storage::sqlite
