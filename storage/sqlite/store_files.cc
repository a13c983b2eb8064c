#include "storage/sqlite/store_files.h"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace uplink::storage::sqlite {

std::uint64_t RoomOfTransaction(const DiskSpace& disk) {
  constexpr std::uint64_t kMax = std::uint64_t{16} << 20;
  return std::min(kMax, disk.total_bytes / 8);
}

absl::StatusOr<std::unique_ptr<StoreFiles>> StoreFiles::Open(Database& database,
                                                             AskDiskSpace disk_space) {
  absl::Status status = database.Execute("PRAGMA wal_autocheckpoint = 0");
  if (!status.ok()) return status;
  if (database.damage() == nullptr) {
    database.ReportDamageTo(std::make_shared<Damage>(database.path()));
  }
  auto names = NamedFiles::Note(database);
  if (!names.ok()) return names.status();
  std::unique_ptr<StoreFiles> files(
      new StoreFiles(database, *std::move(names), std::move(disk_space)));
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
  return FreeRoom();
}

absl::Status StoreFiles::FreeRoom() {
  database_.MoveWal();
  absl::Status status = Look();
  if (!status.ok() || intact_.wal().bytes < kWalLargeBytes) return status;
  const absl::StatusOr<DiskSpace> disk = disk_space_(database_.FileName());
  if (!disk.ok() || disk->free_bytes >= intact_.wal().bytes) return status;
  database_.EmptyWal();
  return Look();
}

absl::Status StoreFiles::CheckRoom() {
  // What is lacking; 0 where it is not known.
  const auto lacks = [this]() -> std::uint64_t {
    if (intact_.wal().unmoved < kHeldAtFrames) return 0;
    const absl::StatusOr<DiskSpace> disk = disk_space_(database_.FileName());
    if (!disk.ok()) return 0;
    const std::uint64_t needed = intact_.wal().owed_bytes + RoomOfTransaction(*disk);
    return needed - std::min(needed, disk->free_bytes);
  };
  if (lacks() == 0) return absl::OkStatus();
  absl::Status status = FreeRoom();
  if (!status.ok()) return status;
  const std::uint64_t lacking = lacks();
  if (lacking == 0) return absl::OkStatus();
  return absl::ResourceExhaustedError(fmt::format(
      "store {}: its WAL has {} bytes that cannot be moved into the file, most likely since another"
      " program reads an old state of it; {} bytes more must be free on the disk to write on",
      database_.FileName(), intact_.wal().bytes, lacking));
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

absl::Status StoreFiles::AfterFailure(absl::Status status) {
  // What went wrong first is told, and damage before that.
  if (absl::IsResourceExhausted(status) && Check().ok()) status.Update(FreeRoom());
  return DamageOr(status);
}

absl::Status StoreFiles::Look() {
  absl::Status looked = intact_.Look();
  if (!absl::IsDataLoss(looked)) return DamageOr(looked);
  damage_->Note(std::string(looked.message()));
  return damage_->status();
}

}  // namespace uplink::storage::sqlite
