// Linked into a program, this becomes SQLite's default way to files: what is not synced is lost
// when the process is killed. Everything else is left to the usual way.
#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <utility>

#include <sqlite3.h>

#include "tests/chaos/held_blocks.h"

namespace uplink::chaos {
namespace {

/// The held blocks of all open files of the process, by path: connections share them.
class Files final {
 public:
  std::shared_ptr<HeldBlocks> Of(const std::string& path, std::int64_t size) {
    const std::lock_guard lock(mutex_);
    std::weak_ptr<HeldBlocks>& known = files_[path];
    std::shared_ptr<HeldBlocks> blocks = known.lock();
    if (blocks == nullptr) {
      blocks = std::make_shared<HeldBlocks>(size, seed_ + files_.size());
      known = blocks;
    }
    return blocks;
  }

 private:
  static std::uint64_t SeedOfTheEnvironment() {
    // NOLINTNEXTLINE(concurrency-mt-unsafe): before any thread.
    const char* seed = std::getenv("UPLINK_HELD_SEED");
    return seed == nullptr ? 1 : std::strtoull(seed, nullptr, 10);
  }

  const std::uint64_t seed_ = SeedOfTheEnvironment();
  std::mutex mutex_;
  std::map<std::string, std::weak_ptr<HeldBlocks>> files_;
};

/// SQLite makes room for it, and behind it for the usual file.
struct File {
  sqlite3_file base;
  /// Null: a file without held blocks.
  std::shared_ptr<HeldBlocks> blocks;
  sqlite3_file* usual;
};

struct Vfs {
  sqlite3_vfs base;
  sqlite3_vfs* usual;
  Files files;
};

File& Of(sqlite3_file* file) { return *reinterpret_cast<File*>(file); }

HeldBlocks::WriteFile Writer(const File& file) {
  return [usual = file.usual](std::span<const char> bytes, std::int64_t offset) {
    return usual->pMethods->xWrite(usual, bytes.data(), static_cast<int>(bytes.size()), offset);
  };
}

/// What is past the end of the file is zero, as SQLite has it.
int ReadUsual(const File& file, std::span<char> bytes, std::int64_t offset) {
  const int code =
      file.usual->pMethods->xRead(file.usual, bytes.data(), static_cast<int>(bytes.size()), offset);
  return code == SQLITE_IOERR_SHORT_READ ? SQLITE_OK : code;
}

int Close(sqlite3_file* base) {
  File& file = Of(base);
  // A close in order: the operating system has it all, if not the disk.
  if (file.blocks != nullptr && file.blocks.use_count() == 1) {
    static_cast<void>(file.blocks->Flush(Writer(file)));
  }
  const int code = file.usual->pMethods->xClose(file.usual);
  file.~File();
  return code;
}

int Read(sqlite3_file* base, void* into, int amount, sqlite3_int64 offset) {
  File& file = Of(base);
  if (file.blocks == nullptr) {
    return file.usual->pMethods->xRead(file.usual, into, amount, offset);
  }
  const std::span bytes(static_cast<char*>(into), static_cast<std::size_t>(amount));
  const int code = file.blocks->Read(bytes, offset, [&](std::span<char> part, std::int64_t at) {
    return ReadUsual(file, part, at);
  });
  if (code != SQLITE_OK) return code;
  return offset + amount > file.blocks->size() ? SQLITE_IOERR_SHORT_READ : SQLITE_OK;
}

int Write(sqlite3_file* base, const void* from, int amount, sqlite3_int64 offset) {
  File& file = Of(base);
  if (file.blocks == nullptr) {
    return file.usual->pMethods->xWrite(file.usual, from, amount, offset);
  }
  return file.blocks->Write(
      {static_cast<const char*>(from), static_cast<std::size_t>(amount)}, offset,
      [&](std::span<char> bytes, std::int64_t at) { return ReadUsual(file, bytes, at); },
      Writer(file));
}

int Truncate(sqlite3_file* base, sqlite3_int64 size) {
  File& file = Of(base);
  if (file.blocks != nullptr) file.blocks->Truncate(size);
  return file.usual->pMethods->xTruncate(file.usual, size);
}

int Sync(sqlite3_file* base, int flags) {
  File& file = Of(base);
  const int code = file.blocks == nullptr ? SQLITE_OK : file.blocks->Flush(Writer(file));
  return code == SQLITE_OK ? file.usual->pMethods->xSync(file.usual, flags) : code;
}

int FileSize(sqlite3_file* base, sqlite3_int64* size) {
  File& file = Of(base);
  if (file.blocks == nullptr) return file.usual->pMethods->xFileSize(file.usual, size);
  *size = file.blocks->size();
  return SQLITE_OK;
}

int Lock(sqlite3_file* base, int lock) {
  return Of(base).usual->pMethods->xLock(Of(base).usual, lock);
}
int Unlock(sqlite3_file* base, int lock) {
  return Of(base).usual->pMethods->xUnlock(Of(base).usual, lock);
}
int CheckReservedLock(sqlite3_file* base, int* found) {
  return Of(base).usual->pMethods->xCheckReservedLock(Of(base).usual, found);
}
int FileControl(sqlite3_file* base, int operation, void* argument) {
  return Of(base).usual->pMethods->xFileControl(Of(base).usual, operation, argument);
}
int SectorSize(sqlite3_file* base) { return Of(base).usual->pMethods->xSectorSize(Of(base).usual); }
int DeviceCharacteristics(sqlite3_file* base) {
  return Of(base).usual->pMethods->xDeviceCharacteristics(Of(base).usual);
}
// The index of the WAL is memory: a kill leaves it, and SQLite makes a new one.
int ShmMap(sqlite3_file* base, int region, int size, int extend, void volatile** memory) {
  return Of(base).usual->pMethods->xShmMap(Of(base).usual, region, size, extend, memory);
}
int ShmLock(sqlite3_file* base, int offset, int count, int flags) {
  return Of(base).usual->pMethods->xShmLock(Of(base).usual, offset, count, flags);
}
void ShmBarrier(sqlite3_file* base) { Of(base).usual->pMethods->xShmBarrier(Of(base).usual); }
int ShmUnmap(sqlite3_file* base, int remove) {
  return Of(base).usual->pMethods->xShmUnmap(Of(base).usual, remove);
}

/// Version 2: with shared memory, without maps of the file itself.
constexpr sqlite3_io_methods kMethods = {2,
                                         Close,
                                         Read,
                                         Write,
                                         Truncate,
                                         Sync,
                                         FileSize,
                                         Lock,
                                         Unlock,
                                         CheckReservedLock,
                                         FileControl,
                                         SectorSize,
                                         DeviceCharacteristics,
                                         ShmMap,
                                         ShmLock,
                                         ShmBarrier,
                                         ShmUnmap,
                                         nullptr,
                                         nullptr};

int Open(sqlite3_vfs* base, const char* name, sqlite3_file* room, int flags, int* out_flags) {
  Vfs& vfs = *reinterpret_cast<Vfs*>(base);
  auto* usual = reinterpret_cast<sqlite3_file*>(reinterpret_cast<char*>(room) + sizeof(File));
  room->pMethods = nullptr;
  const int code = vfs.usual->xOpen(vfs.usual, name, usual, flags, out_flags);
  if (code != SQLITE_OK) return code;
  auto* file = new (room) File{{&kMethods}, nullptr, usual};
  constexpr int kHeld = SQLITE_OPEN_MAIN_DB | SQLITE_OPEN_WAL | SQLITE_OPEN_MAIN_JOURNAL;
  if ((flags & kHeld) == 0 || name == nullptr) return SQLITE_OK;
  sqlite3_int64 size = 0;
  const int sized = usual->pMethods->xFileSize(usual, &size);
  if (sized == SQLITE_OK) file->blocks = vfs.files.Of(name, size);
  return sized;
}

__attribute__((constructor)) void BecomeTheDefault() {
  sqlite3_vfs* usual = sqlite3_vfs_find(nullptr);
  // As long as the process: SQLite keeps a pointer to it.
  auto* vfs = new Vfs{*usual, usual, {}};
  vfs->base.zName = "held";
  vfs->base.szOsFile = static_cast<int>(sizeof(File)) + usual->szOsFile;
  vfs->base.xOpen = Open;
  if (sqlite3_vfs_register(&vfs->base, 1) != SQLITE_OK) std::abort();
}

}  // namespace
}  // namespace uplink::chaos
