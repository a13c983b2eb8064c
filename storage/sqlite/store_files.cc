#include "storage/sqlite/store_files.h"

#include <string>
#include <utility>

#include <fmt/format.h>

namespace uplink::storage::sqlite {

absl::StatusOr<std::unique_ptr<StoreFiles>> StoreFiles::Open(Database& database) {
  absl::Status status = database.Execute("PRAGMA wal_autocheckpoint = 0");
  if (!status.ok()) return status;
  if (database.damage() == nullptr) {
    database.ReportDamageTo(std::make_shared<Damage>(database.path()));
  }
  auto names = NamedFiles::Note(database);
  if (!names.ok()) return names.status();
  std::unique_ptr<StoreFiles> files(new StoreFiles(database, *std::move(names)));
  // After a kill the index does not know how far the last checkpoint came.
  status = files->Look();
  if (status.ok()) {
    database.MoveWal();
    status = files->Look();
  }
  if (!status.ok()) return status;
  return files;
}

absl::Status StoreFiles::Check() {
  absl::Status status = damage_->status();
  if (status.ok()) status = names_->Check();
  return status.ok() ? Look() : status;
}

absl::Status StoreFiles::CheckCommitted() {
  absl::Status status = Check();
  // The database is not compared while a checkpoint that failed has moved some of its frames.
  if (!status.ok() || (intact_.frames() < kMovedAtFrames && intact_.compares())) return status;
  database_.MoveWal();
  return Look();
}

absl::Status StoreFiles::CheckEntry(EntryNumber next) {
  if (next >= next_entry_) return absl::OkStatus();
  damage_->Note(fmt::format("{} went back: its next entry is {}, and {} was committed",
                            database_.FileName(), next, next_entry_));
  return damage_->status();
}

absl::Status StoreFiles::DamageOr(const absl::Status& status) const {
  absl::Status damage = damage_->status();
  return damage.ok() ? status : damage;
}

absl::Status StoreFiles::Look() {
  absl::Status looked = intact_.Look();
  if (!absl::IsDataLoss(looked)) return DamageOr(looked);
  damage_->Note(std::string(looked.message()));
  return damage_->status();
}

}  // namespace uplink::storage::sqlite
