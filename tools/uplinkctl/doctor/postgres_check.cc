#include "tools/uplinkctl/doctor/postgres_check.h"

#include <string>

#include <fmt/core.h>

#include "schema/base/doc_page.h"

namespace uplink::ctl {
namespace {

using storage::postgres::StoreState;

constexpr const char* kKey = "store.url";
constexpr const char* kMigrate =
    "run `uplinkctl store migrate --grant-to ROLE` as the schema's owner";

Finding Unreachable(const absl::Status& status) {
  const std::string text(status.message());
  if (absl::IsUnavailable(status)) {
    return Error(kKey, text,
                 "start the database or correct the URL; a server that starts without it stores "
                 "nothing until it answers");
  }
  return Error(kKey, text,
               DocPage("docs/operate/postgresql.md") + " shows roles, password and schema");
}

Finding SchemaFinding(const StoreState& state, const config::StoreConfig& store) {
  if (!state.schema_fits.ok()) {
    return Error(kKey, std::string(state.schema_fits.message()),
                 "run the version of uplinkd that the schema is of; see " +
                     DocPage("docs/operate/upgrade.md"));
  }
  const std::string text = fmt::format("{} has schema {}, and this program needs {}", state.where,
                                       state.schema_version, state.schema_needed);
  if (state.steps_missing == 0) return Ok(kKey, text);
  if (store.migrate) {
    return Ok(kKey, text + ": the server applies the missing steps, if its role may");
  }
  return Error(kKey, text, kMigrate);
}

void AddWrites(const StoreState& state, Findings& findings) {
  if (state.standby) {
    findings.push_back(Error(kKey, state.where + " is a standby and takes no writes",
                             "promote it, or name the primary as well"));
  } else if (state.read_only) {
    findings.push_back(Error(kKey, state.where + " is read-only (default_transaction_read_only)",
                             "turn that off for the role and the database"));
  }
  if (!state.utf8) {
    findings.push_back(Error(kKey, state.where + " is not encoded in UTF8",
                             "create the database with --encoding UTF8"));
  }
  if (state.tables_denied > 0) {
    findings.push_back(Error(
        kKey,
        fmt::format("the role may not write {} tables of {}", state.tables_denied, state.where),
        kMigrate));
  }
}

void AddDurability(const StoreState& state, const config::StoreConfig& store, Findings& findings) {
  if (!state.fsync) {
    const std::string text = state.where + " has fsync = off: a power cut may lose acked messages";
    const std::string remedy = "set fsync = on in postgresql.conf and reload it";
    findings.push_back(store.accept_unsafe ? Warning(kKey, text, remedy)
                                           : Error(kKey, text, remedy));
  }
  if (!state.full_page_writes) {
    findings.push_back(
        Warning(kKey, state.where + " has full_page_writes = off: a power cut may damage tables",
                "set it to on, unless the file system writes pages whole"));
  }
  if (state.fsync && state.full_page_writes) {
    findings.push_back(
        Ok(kKey, fmt::format("fsync and full_page_writes are on; synchronous_commit is {}, and "
                             "uplinkd sets it to on for each of its transactions",
                             state.synchronous_commit)));
  }
}

Finding OffsetFinding(const StoreState& state) {
  const auto offset = state.clock_offset;
  const std::string text =
      fmt::format("the database's clock is {} ms {} this machine's",
                  std::chrono::abs(offset).count(), offset.count() < 0 ? "behind" : "ahead of");
  if (std::chrono::abs(offset) <= kDatabaseClockApartMax) return Ok(kKey, text);
  return Warning(kKey, text, "let NTP keep both");
}

}  // namespace

Findings PostgresFindings(const absl::StatusOr<StoreState>& state,
                          const config::StoreConfig& store) {
  if (!state.ok()) return {Unreachable(state.status())};
  Findings findings{SchemaFinding(*state, store)};
  AddWrites(*state, findings);
  AddDurability(*state, store, findings);
  findings.push_back(OffsetFinding(*state));
  return findings;
}

}  // namespace uplink::ctl
