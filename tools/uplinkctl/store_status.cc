#include "tools/uplinkctl/store_status.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <variant>

#include <fmt/core.h>

#include "schema/base/clock.h"
#include "server/config/config.h"
#include "storage/sqlite/schema.h"
#include "tools/uplinkctl/command.h"
#include "tools/uplinkctl/doctor/service_user.h"
#include "tools/uplinkctl/doctor/sqlite_check.h"
#include "tools/uplinkctl/show/columns.h"
#include "tools/uplinkctl/store_target.h"

namespace uplink::ctl {
namespace {

std::string_view Yes(bool value) { return value ? "yes" : "no"; }

void Line(std::string_view name, std::string_view text) { fmt::print("{:<15} {}\n", name, text); }

std::string SchemaText(const storage::postgres::StoreState& state) {
  if (state.schema_fits.ok() && state.schema_version <= state.schema_needed) {
    return fmt::format("{} of {}", state.schema_version, state.schema_needed);
  }
  return fmt::format("{} (this program knows {}; {} use it)", state.schema_version,
                     state.schema_needed, state.schema_fits.ok() ? "may" : "may not");
}

int OfDatabase(const storage::postgres::AdminOptions& target) {
  const SystemClock clock;
  const auto state = storage::postgres::ReadState(target, clock);
  if (!state.ok()) return ExitOf(state.status());
  Line("store", state->where);
  Line("server", fmt::format("PostgreSQL {}.{}", state->server_version / 10'000,
                             state->server_version % 10'000));
  Line("schema", SchemaText(*state));
  Line("fsync", Yes(state->fsync));
  Line("takes writes", Yes(!state->read_only && !state->standby));
  Line("clock offset", fmt::format("{} ms", state->clock_offset.count()));
  if (!state->schema_fits.ok()) return ExitOf(state->schema_fits);
  return state->steps_missing == 0 ? kExitDone : kExitFailed;
}

/// The file's own bytes say it; a server that has just made it still has all of it in the WAL.
std::string SchemaText(const SqliteFacts& facts, std::int64_t needed) {
  if (facts.header && facts.header->changes_of_tables > 0) {
    return fmt::format("{} of {}", facts.header->schema_version, needed);
  }
  return facts.wal_filled ? "in the WAL, which only the server reads" : "none";
}

std::string SizeOfFile(const std::string& path) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  return error ? "none" : SizeText(static_cast<double>(bytes));
}

int OfFile(const std::string& path) {
  const SqliteFacts facts = ReadSqliteFacts(path);
  const auto needed = static_cast<std::int64_t>(storage::sqlite::Migrations().size());
  Line("store", path);
  Line("file", SizeOfFile(path));
  Line("WAL", SizeOfFile(path + "-wal"));
  Line("schema", SchemaText(facts, needed));
  Line("server has it", Yes(facts.held));
  if (facts.space) {
    Line("free on disk", SizeText(static_cast<double>(facts.space->free_bytes)));
  }
  config::StoreConfig store;
  store.url = "sqlite://" + path;
  const Findings findings = SqliteFindings(facts, store, needed, CurrentUser().name);
  const auto worst = std::ranges::max_element(findings, {}, &Finding::severity);
  const bool is_there = facts.place == StorePlace::kFile;
  for (const Finding& finding : findings) {
    if (finding.severity != Severity::kOk || !is_there) fmt::print("{}\n", ToText(finding));
  }
  const bool usable = worst == findings.end() || worst->severity != Severity::kError;
  return is_there && usable ? kExitDone : kExitFailed;
}

}  // namespace

int StoreStatus(const storage::postgres::AdminOptions& target) {
  const auto store = TargetOf(target.url, target.password_file);
  if (!store.ok()) return ExitOf(store.status());
  const auto* path = std::get_if<std::string>(&*store);
  return path == nullptr ? OfDatabase(target) : OfFile(*path);
}

}  // namespace uplink::ctl
