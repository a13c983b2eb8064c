#include "tools/uplinkctl/doctor/sqlite_facts.h"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <sys/stat.h>
#include <unistd.h>

#include "storage/sqlite/file_lock.h"

namespace uplink::ctl {
namespace {

/// As Linux follows them.
constexpr int kLinksMax = 40;
constexpr std::string_view kMagic{"SQLite format 3\0", 16};
constexpr std::size_t kChangesOfTablesAt = 40;
constexpr std::size_t kSchemaVersionAt = 60;
constexpr std::size_t kApplicationIdAt = 68;

std::int64_t BigEndian(std::string_view bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (const char c : bytes.substr(at, 4)) number = number << 8U | static_cast<unsigned char>(c);
  return static_cast<std::int32_t>(number);
}

int AccessError(const std::string& path, int mode) {
  return ::access(path.c_str(), mode) == 0 ? 0 : errno;
}

/// Where a link leads, also to what is not there; the path itself if it leads to itself.
std::string RealPath(const std::string& path) {
  std::error_code error;
  const std::filesystem::path real = std::filesystem::canonical(path, error);
  if (!error) return real.string();
  std::filesystem::path at = path;
  for (int links = 0; links < kLinksMax; ++links) {
    const std::filesystem::path next = std::filesystem::read_symlink(at, error);
    if (error) return at.string();
    at = (at.parent_path() / next).lexically_normal();
  }
  return path;
}

StorePlace PlaceOf(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    return errno == ELOOP ? StorePlace::kLoop : StorePlace::kNothing;
  }
  return S_ISREG(status.st_mode) ? StorePlace::kFile : StorePlace::kNoFile;
}

void ReadMain(const std::string& path, SqliteFacts& facts) {
  struct stat status {};
  if (facts.place != StorePlace::kFile || ::stat(path.c_str(), &status) != 0) return;
  facts.links = status.st_nlink;
  std::string bytes(kSqliteHeaderBytes, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  if (!bytes.empty()) facts.header = ParseHeader(bytes);
}

}  // namespace

SqliteHeader ParseHeader(std::string_view bytes) {
  SqliteHeader header;
  header.is_sqlite = bytes.size() >= kSqliteHeaderBytes && bytes.starts_with(kMagic);
  if (!header.is_sqlite) return header;
  header.changes_of_tables = BigEndian(bytes, kChangesOfTablesAt);
  header.schema_version = BigEndian(bytes, kSchemaVersionAt);
  header.application_id = BigEndian(bytes, kApplicationIdAt);
  return header;
}

SqliteFacts ReadSqliteFacts(const std::string& path) {
  SqliteFacts facts;
  facts.path = path;
  facts.place = PlaceOf(path);
  const std::string real = RealPath(path);
  if (facts.place == StorePlace::kNothing && real != path) facts.target = real;
  facts.folder = std::filesystem::path(real).parent_path().string();
  facts.folder_error = AccessError(facts.folder, R_OK | W_OK | X_OK);
  for (const char* suffix : {"", "-wal", "-shm", ".lock"}) {
    const std::string name = real + suffix;
    struct stat status {};
    if (::stat(name.c_str(), &status) != 0) continue;
    facts.files.push_back({name, AccessError(name, R_OK | W_OK)});
  }
  ReadMain(real, facts);
  std::error_code ignored;
  facts.damaged = std::filesystem::exists(real + ".damaged", ignored);
  facts.wal_filled = std::filesystem::exists(real + "-wal", ignored) &&
                     std::filesystem::file_size(real + "-wal", ignored) > 0;
  const absl::StatusOr<bool> held = storage::sqlite::FileLock::IsHeld(path);
  // Rights that are missing show in `files`.
  facts.held = held.ok() && *held;
  if (const auto space = storage::DiskSpaceOf(facts.folder); space.ok()) facts.space = *space;
  return facts;
}

}  // namespace uplink::ctl
