#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/disk_space.h"
#include "storage/sqlite/damage.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/intact_files.h"
#include "storage/sqlite/named_files.h"
#include "storage/sqlite/statement.h"
#include "storage/sqlite/wal.h"

namespace uplink::storage::sqlite {

/// Frames that wait to be moved from which on a transaction needs room beside them: twice what a
/// commit moves, so that a WAL which no reader holds never has so many.
inline constexpr std::uint32_t kHeldAtFrames = 2 * kMovedAtFrames;

/// What a transaction may write to a disk, in bytes: twice the largest batch (8 MiB, the journal's
/// batch_bytes_max), and on a small disk an eighth of it.
[[nodiscard]] std::uint64_t RoomOfTransaction(const DiskSpace& disk);

/// What the disk of a file has left: DiskSpaceOf, or a test's.
using AskDiskSpace = std::function<absl::StatusOr<DiskSpace>(const std::string& path)>;

/// Whether what the writer commits is there at the next start: the names of its files, what is in
/// them, and what any connection of the process found. And whether there is room for it: while
/// another connection reads an old state, SQLite cannot move the WAL into the database, and the WAL
/// grows with each commit. It must leave the room that moving it takes, or nothing could be stored
/// ever again.
///
/// Thread: confined to the writer.
class StoreFiles final {
 public:
  /// Notes the files of a database whose WAL is open. From then on that connection moves the WAL
  /// into the database here alone, after a look: what was written over would be part of both after
  /// it, and look sound.
  ///
  /// Errors: as of Check; kFailedPrecondition if an earlier process found damage that is still
  /// there.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<StoreFiles>> Open(
      Database& database, AskDiskSpace disk_space = DiskSpaceOf);

  /// Errors: kUnavailable, naming file and cause. Of the names it ends when they are right again;
  ///         of damage it stays.
  [[nodiscard]] absl::Status Check();

  /// Before a transaction, after Check: whether the disk has room for it, and for moving the WAL
  /// into the database later. Tries to move it first.
  ///
  /// Errors: kResourceExhausted, naming the file and how long its WAL is; as of Check.
  [[nodiscard]] absl::Status CheckRoom();

  /// Check, and then what a commit of SQLite's own would do: move a long WAL into the database.
  ///
  /// Errors: as of Check.
  [[nodiscard]] absl::Status CheckCommitted();
  /// Moves as much of the WAL into the database as readers allow. Where the WAL is large and the
  /// disk has less left than it takes, gives its room back to the disk once no reader uses it.
  ///
  /// Errors: as of Check.
  [[nodiscard]] absl::Status FreeRoom();

  /// What a transaction read as the number of the store's next entry. A lower one than was
  /// committed shows that another program put an older store there by SQLite's own rules.
  ///
  /// Errors: kUnavailable, from then on of Check too.
  [[nodiscard]] absl::Status CheckEntry(EntryNumber next);
  /// The number that a commit left, or that the store had when it was opened.
  void NoteEntry(EntryNumber next) { next_entry_ = next; }

  /// The status that a call of the store returns after it failed with `status`.
  [[nodiscard]] absl::Status DamageOr(const absl::Status& status) const;
  /// The same after a transaction that was rolled back; frees room if that was lacking.
  [[nodiscard]] absl::Status AfterFailure(absl::Status status);

  StoreFiles(const StoreFiles&) = delete;
  StoreFiles& operator=(const StoreFiles&) = delete;

 private:
  StoreFiles(Database& database, std::unique_ptr<NamedFiles> names, AskDiskSpace disk_space)
      : database_(database),
        disk_space_(std::move(disk_space)),
        damage_(database.damage()),
        names_(std::move(names)),
        intact_(database) {}
  [[nodiscard]] absl::Status Look();

  Database& database_;
  const AskDiskSpace disk_space_;
  const DamagePtr damage_;
  const std::unique_ptr<NamedFiles> names_;
  IntactFiles intact_;
  /// As the last commit left it, of this process or of an earlier one.
  EntryNumber next_entry_ = 0;
};

}  // namespace uplink::storage::sqlite
