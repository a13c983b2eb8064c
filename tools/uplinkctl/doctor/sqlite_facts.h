#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "storage/disk_space.h"

namespace uplink::ctl {

/// What an SQLite file's first bytes say. A value.
struct SqliteHeader {
  bool is_sqlite = false;
  std::int64_t application_id = 0;
  std::int64_t schema_version = 0;
  /// How often tables were made or changed; 0: the file has none.
  std::int64_t changes_of_tables = 0;
};

/// A file of the store that is there.
struct StoreFile {
  std::string path;
  /// Why this user may not read and write it: an errno value, 0 if they may.
  int access_error = 0;
};

/// What the store's path leads to. Closed.
enum class StorePlace : std::uint8_t {
  kNothing,
  kFile,
  /// A pipe, a device or a socket.
  kNoFile,
  /// A link to itself, also by way of others.
  kLoop,
};

/// An SQLite store as it lies on disk. A value.
struct SqliteFacts {
  std::string path;
  StorePlace place = StorePlace::kNothing;
  /// Where a link leads whose target is missing; else empty.
  std::string target;
  /// Of the file itself, where a link leads.
  std::string folder;
  /// Why this user may not make files there, an errno value.
  int folder_error = 0;
  /// Those that exist of the store, its WAL, the WAL's index and the locks.
  std::vector<StoreFile> files;
  /// Of the store's file; nothing if it is not there, or is empty.
  std::optional<SqliteHeader> header;
  /// How many names it has in folders (hard links).
  std::uint64_t links = 0;
  /// The server noted that the file is damaged.
  bool damaged = false;
  /// The WAL beside it holds what was committed, also where there is no file.
  bool wal_filled = false;
  /// Another process holds the store, as a server does.
  bool held = false;
  std::optional<storage::DiskSpace> space;
};

/// Looks at names, rights and the file's first bytes. Nothing is opened by SQLite: where the WAL's
/// index is missing beside a running server, that alone could damage the store. A step of the
/// schema that was applied last and still lies in the WAL does not show. The locks are asked and
/// neither made nor waited for.
///
/// Thread: any; asks the file system.
[[nodiscard]] SqliteFacts ReadSqliteFacts(const std::string& path);

inline constexpr std::size_t kSqliteHeaderBytes = 100;
/// Reads a file's first kSqliteHeaderBytes. A pure function.
///
/// Source: "Database File Format", 1.3, on sqlite.org.
[[nodiscard]] SqliteHeader ParseHeader(std::string_view bytes);

}  // namespace uplink::ctl
