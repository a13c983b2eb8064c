#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <sys/types.h>

#include "storage/sqlite/database.h"

namespace uplink::storage::sqlite {

/// The names under which the next start opens a store's files, and which files they led to when the
/// writer opened them: the database, by the path as given and as SQLite resolved it, its WAL, and
/// the index of the WAL (`-shm`).
///
/// A writer goes on with its open files though their names were removed, moved or given to others,
/// and the next start does not find what it committed. The index belongs to it: another program
/// that opens the database makes a new one where it is missing, its locks are not ours then, and it
/// begins the WAL anew under our commits.
///
/// SQLite opens these files once and makes none of them anew while a connection lives; the last
/// one that closes removes WAL and index.
///
/// Thread: confined to the writer.
class NamedFiles final {
 public:
  /// Notes the files of a database whose WAL is open. Fails if a name leads to another file than
  /// the open one already, so that nothing that happens between opening and noting is missed.
  ///
  /// Errors: as of Check.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<NamedFiles>> Note(Database& database);

  /// OK while every name leads to the open file. One `stat` per name: 1 us each, 6 us in
  /// a virtual machine that intercepts them.
  ///
  /// Errors: kUnavailable, naming file and cause.
  [[nodiscard]] absl::Status Check() const;

  NamedFiles(const NamedFiles&) = delete;
  NamedFiles& operator=(const NamedFiles&) = delete;

 private:
  /// Device and inode. While the file is open no other file gets them.
  using Identity = std::pair<dev_t, ino_t>;
  struct Named {
    std::string name;
    Identity file{};
  };
  static absl::StatusOr<Identity> Look(const std::string& name);
  NamedFiles() = default;

  std::vector<Named> files_;
};

}  // namespace uplink::storage::sqlite
