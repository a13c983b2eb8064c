#include "storage/sqlite/intact_files.h"

#include <cstring>
#include <utility>

#include <sqlite3.h>

#include "storage/sqlite/wal.h"

namespace uplink::storage::sqlite {
namespace {

/// Other connections may write the index while we look; one that changes at each of so many looks
/// is judged by the next commit.
constexpr int kLooksMax = 100;

constexpr std::size_t kDatabaseHeaderBytes = 100;
constexpr std::string_view kMagic("SQLite format 3\0", 16);
/// Of the database: its page size, and the versions that a WAL needs to write and to read.
constexpr std::size_t kPageSizeAt = 16;
constexpr std::string_view kVersions("\2\2", 2);

std::uint32_t BigEndian(std::string_view bytes) {
  std::uint32_t number = 0;
  for (const char byte : bytes) number = number << 8U | static_cast<unsigned char>(byte);
  return number;
}

std::array<std::uint32_t, 2> Words(std::string_view bytes) {
  std::array<std::uint32_t, 2> words{};
  std::memcpy(words.data(), bytes.data(), sizeof words);
  return words;
}

std::array<std::uint32_t, 2> BigEndianWords(std::string_view bytes) {
  return {BigEndian(bytes.substr(0, 4)), BigEndian(bytes.substr(4, 4))};
}

/// What lies behind the file's end is zero.
absl::StatusOr<std::string> Read(const Database& database, sqlite3_file* file, std::int64_t at,
                                 std::size_t bytes) {
  std::string read(bytes, '\0');
  const int code = file->pMethods->xRead(file, read.data(), static_cast<int>(bytes), at);
  if (code != SQLITE_OK && code != SQLITE_IOERR_SHORT_READ) {
    return database.Error(code, "read a file");
  }
  return read;
}

/// 0 if the header is none of a database with a WAL.
std::int64_t PageSizeOf(std::string_view header) {
  if (header.substr(0, kMagic.size()) != kMagic) return 0;
  if (header.substr(kPageSizeAt + 2, kVersions.size()) != kVersions) return 0;
  const std::uint32_t size = BigEndian(header.substr(kPageSizeAt, 2));
  return size == 1 ? 65536 : size;
}

}  // namespace

absl::Status IntactFiles::Look() {
  for (int look = 0; look < kLooksMax; ++look) {
    const absl::StatusOr<std::optional<WalIndex>> before = ReadWalIndex(database_);
    if (!before.ok()) return before.status();
    if (!*before) continue;
    absl::StatusOr<Seen> seen = See(**before);
    if (!seen.ok()) return seen.status();
    const absl::StatusOr<std::optional<WalIndex>> after = ReadWalIndex(database_);
    if (!after.ok()) return after.status();
    if (*before == *after) return Judge(**before, *std::move(seen));
  }
  return absl::OkStatus();
}

absl::StatusOr<IntactFiles::Seen> IntactFiles::See(const WalIndex& index) const {
  const absl::StatusOr<sqlite3_file*> file = OpenDatabaseFile(database_);
  if (!file.ok()) return file.status();
  const absl::StatusOr<std::int64_t> size = SizeOf(database_, *file);
  if (!size.ok()) return size.status();
  absl::StatusOr<std::string> header = Read(database_, *file, 0, kDatabaseHeaderBytes);
  if (!header.ok()) return header.status();
  Seen seen;
  seen.database_bytes = *size;
  const std::int64_t page = PageSizeOf(*header);
  if (page == 0) return seen;
  absl::StatusOr<std::string> first = Read(database_, *file, 0, static_cast<std::size_t>(page));
  if (!first.ok()) return first.status();
  seen.first_page = *std::move(first);
  const absl::StatusOr<std::int64_t> wal = WalBytes(index);
  if (!wal.ok()) return wal.status();
  seen.wal_bytes = *wal;
  absl::StatusOr<std::string> fault = WalFault(index, seen);
  if (!fault.ok()) return fault.status();
  seen.wal_fault = *std::move(fault);
  return seen;
}

absl::StatusOr<std::int64_t> IntactFiles::WalBytes(const WalIndex& index) const {
  // Begun anew, and not written yet; another connection may just have emptied it.
  if (index.last_frame() == 0) return 0;
  const absl::StatusOr<sqlite3_file*> wal = OpenWalFile(database_);
  if (!wal.ok()) return wal.status();
  return SizeOf(database_, *wal);
}

absl::StatusOr<std::string> IntactFiles::WalFault(const WalIndex& index, const Seen& seen) const {
  if (index.last_frame() == 0) return std::string();
  const auto page = static_cast<std::int64_t>(seen.first_page.size());
  if (seen.wal_bytes < EndOfFrame(index.last_frame(), page)) {
    return std::string("it was cut short");
  }
  const absl::StatusOr<sqlite3_file*> wal = OpenWalFile(database_);
  if (!wal.ok()) return wal.status();
  const absl::StatusOr<std::string> header = Read(database_, *wal, 0, kWalHeaderBytes);
  if (!header.ok()) return header.status();
  bool sound = Words(std::string_view(*header).substr(16)) == index.salts();
  for (const Frame& frame : {last_, Frame{index.last_frame(), index.checksum(), index.salts()}}) {
    if (frame.frame == 0 || frame.salts != index.salts()) continue;
    const auto read = Read(database_, *wal, EndOfFrame(frame.frame - 1, page), kFrameHeaderBytes);
    if (!read.ok()) return read.status();
    const std::string_view bytes = *read;
    sound = sound && Words(bytes.substr(8)) == frame.salts &&
            BigEndianWords(bytes.substr(16)) == frame.checksum;
  }
  return std::string(sound ? "" : "something other than SQLite wrote to it");
}

absl::Status IntactFiles::Judge(const WalIndex& index, Seen seen) {
  if (seen.first_page.empty())
    return Lost("",
                "its header is none of a database with a WAL: it was cut short, or another file "
                "was copied over it");
  if (!seen.wal_fault.empty()) return Lost("-wal", seen.wal_fault);
  const auto page = static_cast<std::int64_t>(seen.first_page.size());
  const bool rests = index.moved == index.moving;
  if (rests && index.moved >= index.last_frame() && seen.database_bytes < page * index.pages()) {
    return Lost("", "it was cut short");
  }
  const bool compares =
      rests && rested_ && rested_->salts == index.salts() && rested_->moved == index.moved;
  if (compares &&
      (rested_->bytes != seen.database_bytes || rested_->first_page != seen.first_page)) {
    return Lost("", "something other than SQLite wrote to it");
  }
  last_ = {index.last_frame(), index.checksum(), index.salts()};
  wal_ = WalStateOf(index, {seen.wal_bytes, seen.database_bytes, page});
  rested_.reset();
  if (rests) {
    rested_ = {index.salts(), index.moved, seen.database_bytes, std::move(seen.first_page)};
  }
  return absl::OkStatus();
}

absl::Status IntactFiles::Lost(std::string_view end, std::string_view what) const {
  std::string text = database_.FileName();
  text.append(end).append(" is not what its index says: ").append(what);
  return absl::DataLossError(text);
}

}  // namespace uplink::storage::sqlite
