#include "tests/simulation/sqlite_backend.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "schema/base/check.h"
#include "tests/simulation/rows.h"
#include "tests/support/sqlite_shell.h"

namespace uplink::simulation {
std::string SqliteBackend::Path() const { return folder_.path() + "/sim.db"; }

storage::Store& SqliteBackend::Reopen(const storage::ProcessId& process) {
  const bool first = store_ == nullptr;
  store_.reset();
  storage::sqlite::StoreOptions options;
  options.process = process;
  auto opened = storage::sqlite::SqliteStore::Open(Path(), options);
  UPLINK_CHECK(opened.ok(), opened.status().ToString());
  store_ = *std::move(opened);
  if (first) {
    testing::SqliteShell(Path()).Run(
        fmt::format("CREATE TRIGGER refuse BEFORE INSERT ON faults_active WHEN NEW.fault_id = '{}' "
                    "BEGIN SELECT RAISE(ABORT, 'refused on order'); END",
                    kRefusedFaultId));
  }
  return *store_;
}

void SqliteBackend::DeleteRobotRow(const std::string& ruri) {
  testing::SqliteShell(Path()).Run(fmt::format("DELETE FROM robots WHERE ruri = '{}'", ruri));
}

void SqliteBackend::RemoveRobot(const std::string& ruri) {
  std::string sql;
  for (const char* table : {"robots", "shapes", "objects"}) {
    sql += fmt::format("DELETE FROM {} WHERE ruri = '{}';", table, ruri);
  }
  testing::SqliteShell(Path()).Run(sql);
}

void SqliteBackend::ForgetSamples() const {
  testing::SqliteShell(Path()).Run("UPDATE samples SET digests = x''");
}

bool SqliteBackend::ReplaceFiles() {
  ++replaced_;
  for (const char* tail : {"", "-wal", "-shm"}) {
    const std::string name = Path() + tail;
    const std::string aside = fmt::format("{}/gone-{}.db{}", folder_.path(), replaced_, tail);
    std::filesystem::rename(name, aside);
    // An index is made anew where it is missing.
    if (std::string_view(tail) != "-shm") std::filesystem::copy_file(aside, name);
  }
  return true;
}

storage::SharedItems& SqliteBackend::Items() {
  auto opened = storage::sqlite::OpenSharedItems(Path());
  UPLINK_CHECK(opened.ok(), opened.status().ToString());
  items_ = *std::move(opened);
  return *items_;
}

storage::Reader& SqliteBackend::Rows() {
  auto opened = storage::sqlite::SqliteReader::Open(Path());
  UPLINK_CHECK(opened.ok(), opened.status().ToString());
  reader_ = *std::move(opened);
  return *reader_;
}

std::optional<std::string> SqliteBackend::Compare(const Recorder& recorder) {
  auto reader = storage::sqlite::SqliteReader::Open(Path());
  UPLINK_CHECK(reader.ok(), reader.status().ToString());
  std::map<std::string, std::size_t> faults;
  std::map<std::string, std::set<std::pair<model::SessionId, model::Seq>>> quarantined;
  for (const auto& [key, durable] : recorder.sessions()) {
    faults[key.first] += durable.faults;
    for (const auto& [seq, reason] : durable.quarantined) {
      // A limited number has no row of quarantine.
      if (reason == model::RejectReason::kRateLimited) continue;
      quarantined[key.first].emplace(key.second, seq);
    }
  }
  for (const auto& [ruri, count] : faults) {
    const auto rows = AllRows<storage::FaultRow>(ruri, [&](const storage::HistoryQuery& query) {
      return (*reader)->FaultHistory({.rows = query});
    });
    if (rows.size() != count) {
      return fmt::format("{} has {} fault reports, the book says {}", ruri, rows.size(), count);
    }
  }
  for (const auto& [ruri, numbers] : quarantined) {
    const auto rows = AllRows<storage::QuarantineRow>(
        ruri,
        [&](const storage::HistoryQuery& query) { return (*reader)->Quarantine({.rows = query}); });
    std::set<std::pair<model::SessionId, model::Seq>> found;
    for (const storage::QuarantineRow& row : rows) found.emplace(row.session, row.seq);
    // What was too old may have been deleted.
    const bool all = retained_ ? std::ranges::includes(numbers, found) : found == numbers;
    if (rows.size() != found.size() || !all) {
      return fmt::format("{} has {} numbers in quarantine, the book says {}", ruri, rows.size(),
                         numbers.size());
    }
  }
  for (const auto& [ruri, changes] : recorder.presence_history()) {
    const auto rows = AllRows<storage::PresenceRow>(ruri, [&](const storage::HistoryQuery& query) {
      return (*reader)->PresenceChanges(query);
    });
    if (auto difference = ComparePresence(ruri, rows, changes)) return difference;
  }
  return std::nullopt;
}

}  // namespace uplink::simulation
