#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/sqlite/database.h"

struct sqlite3_file;

// The files that SQLite has open, by its own descriptors (one of ours would drop SQLite's locks
// when it is closed), the index of the WAL, and what the WAL takes of the disk.
namespace uplink::storage::sqlite {

/// Errors: kUnavailable if it is not open.
[[nodiscard]] absl::StatusOr<sqlite3_file*> OpenDatabaseFile(const Database& database);
[[nodiscard]] absl::StatusOr<sqlite3_file*> OpenWalFile(const Database& database);

/// In bytes.
///
/// Errors: kUnavailable if it cannot be asked.
[[nodiscard]] absl::StatusOr<std::int64_t> SizeOf(const Database& database, sqlite3_file* file);

/// What the index of an open WAL (`-shm`) says. Numbers are in the machine's order, salts as they
/// stand in the WAL. A value.
///
/// Source: sqlite.org/walformat.html.
struct WalIndex {
  /// The first copy of its header, in words of four bytes.
  std::array<std::uint32_t, 12> header{};
  /// Frames that were moved into the database, and that one tried to move.
  std::uint32_t moved = 0;
  std::uint32_t moving = 0;

  bool operator==(const WalIndex&) const = default;
  /// Of the last commit; 0 if the WAL has none.
  [[nodiscard]] std::uint32_t last_frame() const { return header[4]; }
  /// Of the database as of the last commit.
  [[nodiscard]] std::uint32_t pages() const { return header[5]; }
  [[nodiscard]] std::array<std::uint32_t, 2> checksum() const { return {header[6], header[7]}; }
  /// Others once the WAL begins anew.
  [[nodiscard]] std::array<std::uint32_t, 2> salts() const { return {header[8], header[9]}; }
};

/// Of a connection whose WAL is open; nothing while another connection writes the index.
///
/// Errors: kUnavailable if it cannot be read.
[[nodiscard]] absl::StatusOr<std::optional<WalIndex>> ReadWalIndex(const Database& database);

inline constexpr std::int64_t kWalHeaderBytes = 32;
inline constexpr std::int64_t kFrameHeaderBytes = 24;

/// Where a frame ends in the WAL's file; frame 0 is the header. `page`: the bytes of a page.
[[nodiscard]] constexpr std::int64_t EndOfFrame(std::uint32_t frame, std::int64_t page) {
  return kWalHeaderBytes + std::int64_t{frame} * (kFrameHeaderBytes + page);
}

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
