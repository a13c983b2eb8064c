#include "tools/uplinkctl/store_access.h"

#include <array>
#include <cstdio>
#include <variant>

#include <fmt/core.h>
#include <pwd.h>
#include <unistd.h>

#include "server/admin/audit_rows.h"
#include "storage/postgres/parts.h"
#include "storage/postgres/reader.h"
#include "storage/sqlite/parts.h"
#include "storage/sqlite/reader.h"
#include "tools/terminal/terminal.h"
#include "tools/uplinkctl/show/one_line.h"
#include "tools/uplinkctl/store_target.h"

namespace uplink::ctl {
namespace {

/// Bytes of an entry of the users' database.
constexpr std::size_t kUserBytesMax = 4'096;
/// Bytes of a machine's name (gethostname(2)).
constexpr std::size_t kHostBytesMax = 64;

std::string NameOf(uid_t uid) {
  passwd entry{};
  passwd* found = nullptr;
  std::array<char, kUserBytesMax> buffer{};
  const int failed = ::getpwuid_r(uid, &entry, buffer.data(), buffer.size(), &found);
  if (failed == 0 && found != nullptr) return entry.pw_name;
  return fmt::format("user {}", uid);
}

/// Empty if it has none.
std::string MachineName() {
  std::array<char, kHostBytesMax + 1> name{};
  if (::gethostname(name.data(), kHostBytesMax) != 0) return {};
  return name.data();
}

}  // namespace

absl::StatusOr<std::unique_ptr<storage::AccessStore>> OpenAccess(const std::string& url,
                                                                 const std::string& password_file,
                                                                 const Clock& clock) {
  const auto target = TargetOf(url, password_file);
  if (!target.ok()) return target.status();
  if (const auto* path = std::get_if<std::string>(&*target)) {
    return storage::sqlite::OpenAccessStore(*path);
  }
  return storage::postgres::MakeAccessStore(std::get<storage::postgres::StoreOptions>(*target),
                                            clock);
}

absl::StatusOr<std::unique_ptr<storage::Reader>> OpenReader(const std::string& url,
                                                            const std::string& password_file,
                                                            const Clock& clock) {
  const auto target = TargetOf(url, password_file);
  if (!target.ok()) return target.status();
  if (const auto* path = std::get_if<std::string>(&*target)) {
    return storage::sqlite::SqliteReader::Open(*path);
  }
  storage::postgres::ReaderOptions options;
  options.url = url;
  options.password_file = password_file;
  options.connections = 1;
  return storage::postgres::PostgresReader::Open(options, clock);
}

admin::Asker ThisUser() {
  std::string user = NameOf(::getuid());
  const std::string_view by = VariableIn(environ, "SUDO_USER");
  if (::getuid() == 0 && !by.empty()) user += fmt::format(", by sudo of {}", by);
  return admin::StoreAsker(std::move(user), MachineName());
}

void NoteDone(const std::string& url, const std::string& password_file, std::string_view action,
              const std::string& target) {
  const SystemClock clock;
  const auto opened = OpenAccess(url, password_file, clock);
  absl::Status status = opened.status();
  if (opened.ok()) {
    status = (*opened)->Append(admin::RowOf(ThisUser(), {.action = action, .target = target},
                                            absl::OkStatus(), clock.System()));
  }
  if (status.ok()) return;
  fmt::print(stderr, "uplinkctl: it is done, but is not in the audit: {}\n",
             OneLine(std::string(status.message())));
}

}  // namespace uplink::ctl
