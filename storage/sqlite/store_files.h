#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/sqlite/damage.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/entry_number.h"
#include "storage/sqlite/intact_files.h"
#include "storage/sqlite/named_files.h"

namespace uplink::storage::sqlite {

/// Frames of the WAL from which on a commit moves them into the database: SQLite's own default.
inline constexpr std::uint32_t kMovedAtFrames = 1'000;

/// Whether what the writer commits is there at the next start: the names of its files, what is in
/// them, and what any connection of the process found.
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
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<StoreFiles>> Open(Database& database);

  /// Errors: kUnavailable, naming file and cause. Of the names it ends when they are right again;
  ///         of damage it stays.
  [[nodiscard]] absl::Status Check();

  /// Check, and then what a commit of SQLite's own would do: move a long WAL into the database.
  ///
  /// Errors: as of Check.
  [[nodiscard]] absl::Status CheckCommitted();

  /// What a transaction read as the number of the store's next entry. A lower one than was
  /// committed shows that another program put an older store there by SQLite's own rules.
  ///
  /// Errors: kUnavailable, from then on of Check too.
  [[nodiscard]] absl::Status CheckEntry(EntryNumber next);
  /// The number that a commit left, or that the store had when it was opened.
  void NoteEntry(EntryNumber next) { next_entry_ = next; }

  /// What a call of the store that failed with `status` is to say.
  [[nodiscard]] absl::Status DamageOr(const absl::Status& status) const;

  StoreFiles(const StoreFiles&) = delete;
  StoreFiles& operator=(const StoreFiles&) = delete;

 private:
  StoreFiles(Database& database, std::unique_ptr<NamedFiles> names)
      : database_(database),
        damage_(database.damage()),
        names_(std::move(names)),
        intact_(database) {}
  [[nodiscard]] absl::Status Look();

  Database& database_;
  const DamagePtr damage_;
  const std::unique_ptr<NamedFiles> names_;
  IntactFiles intact_;
  /// As the last commit left it, of this process or of an earlier one.
  EntryNumber next_entry_ = 0;
};

}  // namespace uplink::storage::sqlite
