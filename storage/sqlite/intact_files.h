#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/sqlite/database.h"
#include "storage/sqlite/wal.h"

namespace uplink::storage::sqlite {

/// Compares the open database and its WAL with what the index of the WAL (`-shm`) says of them.
/// Another program may write into them, or cut them short, past SQLite's locks (`cp` over the file,
/// `> uplinkd.db-wal`); SQLite itself reads neither again before it needs to.
///
/// It fails for nothing that SQLite does, by any connection of any process (commits, checkpoints,
/// backups, VACUUM, an end):
/// - of the WAL, the header and the last committed frame are those of the index, and the last frame
///   that was seen before is still there, until the WAL begins anew;
/// - of the database, the header is a WAL database's; once all frames were moved into it, it is as
///   long as the index says; and between two looks between which no frame was moved, neither its
///   length nor its first page changes: only a checkpoint writes to it.
///
/// It does not see other pages that are written over: SQLite finds those when it reads them.
///
/// Thread: confined to that of the database.
/// Source: sqlite.org/walformat.html, sqlite.org/fileformat2.html.
class IntactFiles final {
 public:
  /// `database` must outlive it, with its WAL open.
  explicit IntactFiles(Database& database) : database_(database) {}

  /// Some eight system calls.
  ///
  /// Errors: kDataLoss, naming the file, if one is not what the index says; kUnavailable if one
  ///         cannot be read.
  [[nodiscard]] absl::Status Look();

  /// Committed frames in the WAL, as of the last look.
  [[nodiscard]] std::uint32_t frames() const { return last_.frame; }
  /// As of the last look; without the size of a WAL that has no frame.
  [[nodiscard]] const WalState& wal() const { return wal_; }
  /// Whether the next look compares the database with what the last one saw.
  [[nodiscard]] bool compares() const { return rested_.has_value(); }

 private:
  /// A committed frame of the WAL; number 0 is none.
  struct Frame {
    std::uint32_t frame = 0;
    std::array<std::uint32_t, 2> checksum{};
    std::array<std::uint32_t, 2> salts{};
  };
  /// The database while no frame is moved into it.
  struct Rested {
    std::array<std::uint32_t, 2> salts{};
    std::uint32_t moved = 0;
    std::int64_t bytes = 0;
    std::string first_page;
  };
  /// What stands in the files.
  struct Seen {
    std::int64_t database_bytes = 0;
    std::int64_t wal_bytes = 0;
    std::string first_page;
    /// Names what is wrong with the WAL; empty if nothing is.
    std::string wal_fault;
  };

  [[nodiscard]] absl::StatusOr<Seen> See(const WalIndex& index) const;
  /// 0 for a WAL without frames.
  [[nodiscard]] absl::StatusOr<std::int64_t> WalBytes(const WalIndex& index) const;
  [[nodiscard]] absl::StatusOr<std::string> WalFault(const WalIndex& index, const Seen& seen) const;
  [[nodiscard]] absl::Status Judge(const WalIndex& index, Seen seen);
  [[nodiscard]] absl::Status Lost(std::string_view end, std::string_view what) const;

  Database& database_;
  Frame last_;
  WalState wal_;
  std::optional<Rested> rested_;
};

}  // namespace uplink::storage::sqlite
