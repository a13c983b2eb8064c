#include "tools/uplinkctl/doctor/sqlite_check.h"

#include <cerrno>
#include <string>
#include <system_error>

#include <fmt/core.h>

#include "storage/sqlite/schema.h"

namespace uplink::ctl {
namespace {

constexpr const char* kKey = "store.url";
constexpr const char* kSqlitePage = "docs/operate/sqlite.md";

std::string Reason(int error) { return std::generic_category().message(error); }

Finding SchemaFinding(const SqliteFacts& facts, const config::StoreConfig& store,
                      std::int64_t needed) {
  if (facts.wal_alone) {
    return Error(kKey, fmt::format("{} is missing or empty, and its -wal holds rows", facts.path),
                 fmt::format("do not start the server, follow {}", kSqlitePage));
  }
  if (!facts.header) {
    return Ok(kKey, fmt::format("{} is not there yet: the server makes it", facts.path));
  }
  const SqliteHeader& header = *facts.header;
  if (!header.is_sqlite || header.application_id != storage::sqlite::kApplicationId) {
    return Error(kKey, fmt::format("{} is not a store of uplinkd", facts.path),
                 "name another file, or restore a backup");
  }
  const std::string text = fmt::format("{} has schema {}, and this program needs {}", facts.path,
                                       header.schema_version, needed);
  if (header.schema_version > needed) {
    return Warning(kKey, text, "docs/operate/upgrade.md says which program may use it");
  }
  if (header.schema_version == needed || store.migrate) return Ok(kKey, text);
  return Error(kKey, text, "start the server once with store.migrate = true");
}

}  // namespace

Findings SqliteFindings(const SqliteFacts& facts, const config::StoreConfig& store,
                        std::int64_t schema_needed, const std::string& user) {
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
    findings.push_back(Error(kKey,
                             fmt::format("{} has {} names (hard links)", facts.path, facts.links),
                             fmt::format("remove all but one, as {} shows", kSqlitePage)));
  }
  if (facts.damaged) {
    findings.push_back(Error(kKey, fmt::format("{} was found damaged", facts.path),
                             fmt::format("follow {}", kSqlitePage)));
  }
  const bool unread =
      !facts.header && !facts.files.empty() && facts.files.front().access_error != 0;
  if (!unread) findings.push_back(SchemaFinding(facts, store, schema_needed));
  return findings;
}

}  // namespace uplink::ctl
