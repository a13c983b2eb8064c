#include "storage/postgres/data_folder.h"

#include <optional>
#include <string_view>
#include <vector>

#include <sys/stat.h>
#include <sys/types.h>

namespace uplink::storage::postgres {
namespace {

// A role without the right finds no such setting, where SHOW would fail. What stands between us and
// the server may be on this machine, and the server on another: it says how it was reached.
constexpr std::string_view kAsk =
    "SELECT coalesce(nullif(pg_tablespace_location(d.dattablespace), ''),"
    " (SELECT setting FROM pg_settings WHERE name = 'data_directory'), '')"
    " FROM pg_database AS d WHERE d.datname = current_database() AND inet_server_addr() IS NULL";

bool IsFolderOf(const std::string& path, uid_t user) {
  struct stat found {};
  return ::stat(path.c_str(), &found) == 0 && S_ISDIR(found.st_mode) && found.st_uid == user;
}

}  // namespace

absl::StatusOr<std::string> ReadDataFolder(Connection& connection) {
  const std::optional<uid_t> server = connection.peer_user();
  if (!server) return std::string();
  std::vector<StoreCall> calls;
  calls.push_back({kAsk, {}});
  const auto answer = connection.Run(calls, "ask for the data folder");
  if (!answer.ok()) return answer.status();
  const Result& row = answer->front();
  std::string folder = row.rows() == 0 ? std::string() : std::string(row.Bytes(0, 0));
  if (!folder.starts_with('/') || !IsFolderOf(folder, *server)) folder.clear();
  return folder;
}

}  // namespace uplink::storage::postgres
