#include "tools/uplinkctl/doctor/sqlite_check.h"

#include <cerrno>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "schema/base/doc_page.h"
#include "storage/sqlite/schema.h"

namespace uplink::ctl {
namespace {

constexpr const char* kKey = "store.url";

std::string Reason(int error) { return std::generic_category().message(error); }

/// Nothing has been written from the WAL into the file yet.
bool IsFresh(const SqliteHeader& header) {
  return header.is_sqlite && header.application_id == 0 && header.schema_version == 0 &&
         header.changes_of_tables == 0;
}

/// Why no server opens what the path leads to; nothing if that is a file, or can become one.
std::optional<Finding> PlaceFinding(const SqliteFacts& facts, const std::string& user) {
  constexpr const char* kRemedy = "name a file";
  if (facts.place == StorePlace::kLoop) {
    return Error(kKey, fmt::format("{} is a link that leads to itself", facts.path), kRemedy);
  }
  if (facts.place == StorePlace::kNoFile) {
    return Error(kKey, fmt::format("{} is no regular file", facts.path), kRemedy);
  }
  if (!facts.target.empty() && facts.folder_error == ENOENT) {
    return Error(
        kKey, fmt::format("{} is a link to {}, whose folder is missing", facts.path, facts.target),
        fmt::format("name a file, or run install -d -o {} {}", user, facts.folder));
  }
  return std::nullopt;
}

constexpr const char* kMigrateOnce = "start the server once with store.migrate = true";

/// There is no file, or an empty one.
Finding NoTablesFinding(const SqliteFacts& facts, const config::StoreConfig& store) {
  const bool is_there = facts.place == StorePlace::kFile;
  const std::string text =
      is_there ? facts.path + " is empty"
               : (facts.target.empty() ? facts.path : facts.target) + " is not there yet";
  if (!store.migrate) return Error(kKey, text + ", and store.migrate is false", kMigrateOnce);
  return Ok(kKey, text + (is_there ? ": the server makes its tables" : ": the server makes it"));
}

Finding SchemaFinding(const SqliteFacts& facts, const config::StoreConfig& store,
                      std::int64_t needed) {
  if (!facts.header && facts.wal_filled) {
    return Error(kKey, fmt::format("{} is missing or empty, and its -wal holds rows", facts.path),
                 "do not start the server, follow " +
                     DocPage("docs/operate/sqlite.md", "The file was overwritten or damaged"));
  }
  if (!facts.header) return NoTablesFinding(facts, store);
  const SqliteHeader& header = *facts.header;
  if (IsFresh(header) && facts.wal_filled) {
    return Ok(kKey,
              fmt::format("{}: its schema is still in the -wal; the server reads it when it starts",
                          facts.path));
  }
  if (!header.is_sqlite || header.application_id != storage::sqlite::kApplicationId) {
    return Error(kKey, fmt::format("{} is not a store of uplinkd", facts.path),
                 "name another file, or restore a backup");
  }
  const std::string text = fmt::format("{} has schema {}, and this program needs {}", facts.path,
                                       header.schema_version, needed);
  if (header.schema_version > needed) {
    return Warning(kKey, text,
                   DocPage("docs/operate/upgrade.md") + " says which program may use it");
  }
  if (header.schema_version == needed || store.migrate) return Ok(kKey, text);
  return Error(kKey, text, kMigrateOnce);
}

}  // namespace

Findings SqliteFindings(const SqliteFacts& facts, const config::StoreConfig& store,
                        std::int64_t schema_needed, const std::string& user) {
  if (auto place = PlaceFinding(facts, user)) return {*std::move(place)};
  Findings findings;
  if (facts.folder_error != 0) {
    findings.push_back(Error(kKey,
                             fmt::format("{} may not write the folder {}: {}", user, facts.folder,
                                         Reason(facts.folder_error)),
                             fmt::format("run chown {} {}", user, facts.folder)));
    // Where the folder cannot be entered nothing is known of the files.
    if (facts.files.empty()) return findings;
  }
  for (const StoreFile& file : facts.files) {
    if (file.access_error == 0) continue;
    findings.push_back(Error(
        kKey, fmt::format("{} may not write {}: {}", user, file.path, Reason(file.access_error)),
        fmt::format("run chown {} {}", user, file.path)));
  }
  if (facts.links > 1) {
    findings.push_back(Error(
        kKey, fmt::format("{} has {} names (hard links)", facts.path, facts.links),
        "remove all but one, as " +
            DocPage("docs/operate/sqlite.md", "Why does it refuse a file with several names?") +
            " shows"));
  }
  if (facts.damaged) {
    findings.push_back(Error(
        kKey, fmt::format("{} was found damaged", facts.path),
        "follow " + DocPage("docs/operate/sqlite.md", "The file was overwritten or damaged")));
  }
  const bool unread =
      !facts.header && !facts.files.empty() && facts.files.front().access_error != 0;
  if (!unread) findings.push_back(SchemaFinding(facts, store, schema_needed));
  return findings;
}

Findings HolderFindings(const SqliteFacts& facts, StoreHolder holder) {
  if (!facts.held || holder == StoreHolder::kOwnServer) return {};
  const std::string used = fmt::format("{} is in use by another process", facts.path);
  if (holder == StoreHolder::kUnknown) {
    return {Warning(kKey, used + ", which may be a server of this configuration",
                    "set fixed ports: by them its server is known")};
  }
  return {Error(kKey, used + ", and no uplinkd has the ports of this configuration",
                "stop that process, or name another file")};
}

}  // namespace uplink::ctl
