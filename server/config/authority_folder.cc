#include "server/config/authority_folder.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <toml++/toml.h>

#include "schema/base/file_text.h"
#include "server/config/file_modes.h"
#include "server/config/units.h"
#include "server/identity/authorities.h"
#include "server/identity/fleet_name.h"
#include "server/identity/pem_file.h"

namespace uplink::config {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPem = ".pem";
constexpr const char* kToml = ".toml";
constexpr std::size_t kEntryBytesMax = 64 * kKiB;

absl::Status Unfit(const fs::path& path, const std::string& why) {
  return absl::FailedPreconditionError(fmt::format("{}: {}", path.string(), why));
}

struct Entry {
  identity::AuthorityRule rule;
  std::string crl_file;
};

/// A list of texts; nothing if it is something else.
std::optional<std::vector<std::string>> TextsOf(const toml::node& node) {
  const toml::array* const array = node.as_array();
  if (array == nullptr || array->empty()) return std::nullopt;
  std::vector<std::string> texts;
  for (const toml::node& each : *array) {
    const auto text = each.value_exact<std::string>();
    if (!text) return std::nullopt;
    texts.push_back(*text);
  }
  return texts;
}

absl::Status TakeRoles(const fs::path& path, const toml::node& node, Entry& entry) {
  const auto texts = TextsOf(node);
  if (!texts) return Unfit(path, R"(roles must be a list such as ["robot", "gateway"])");
  for (const std::string& text : *texts) {
    const std::optional<identity::Role> role = identity::RoleOf(text);
    if (!role) return Unfit(path, fmt::format("roles: \"{}\" is no role", text));
    entry.rule.roles.push_back(*role);
  }
  return absl::OkStatus();
}

absl::Status TakeFleets(const fs::path& path, const toml::node& node, Entry& entry) {
  auto texts = TextsOf(node);
  if (!texts) return Unfit(path, R"(fleets must be a list such as ["north"], or ["*"] for all)");
  if (std::ranges::find(*texts, identity::kAllFleets) != texts->end()) {
    return texts->size() == 1 ? absl::OkStatus()
                              : Unfit(path, "fleets: \"*\" stands for all, and alone");
  }
  if (texts->size() > identity::kScopeFleetsMax) {
    return Unfit(path, fmt::format("fleets has more than {}", identity::kScopeFleetsMax));
  }
  for (const std::string& text : *texts) {
    if (const auto flaw = identity::FlawOfFleet(text)) return Unfit(path, "fleets: one " + *flaw);
  }
  entry.rule.fleets = identity::Scope::Of(*std::move(texts));
  return absl::OkStatus();
}

absl::Status TakeKey(const fs::path& path, std::string_view key, const toml::node& node,
                     Entry& entry) {
  if (key == "roles") return TakeRoles(path, node, entry);
  if (key == "fleets") return TakeFleets(path, node, entry);
  if (key != "crl_file") {
    return Unfit(path, fmt::format("{} is no key; it takes roles, fleets and crl_file", key));
  }
  const auto text = node.value_exact<std::string>();
  if (!text || text->empty()) return Unfit(path, "crl_file must be a path");
  entry.crl_file = (path.parent_path() / *text).string();
  return absl::OkStatus();
}

absl::StatusOr<Entry> ReadEntry(const fs::path& path) {
  const FileText file = ReadFileText(path.string(), kEntryBytesMax);
  if (!file.problem.empty()) return Unfit(path, file.problem);
  if (absl::Status good = CheckWriters(path.string()); !good.ok()) return good;
  Entry entry{.rule = {.name = path.stem().string()}, .crl_file = {}};
  try {
    const toml::table table = toml::parse(file.text);
    for (const auto& [key, node] : table) {
      if (absl::Status taken = TakeKey(path, key.str(), node, entry); !taken.ok()) return taken;
    }
  } catch (const toml::parse_error& error) {
    return Unfit(path, fmt::format("line {}: {}", error.source().begin.line, error.description()));
  }
  return entry;
}

absl::Status Take(const fs::path& path, AuthorityFolder& folder) {
  auto pem = identity::ReadPem(path.string());
  if (!pem.ok()) return pem.status();
  if (absl::Status good = CheckWriters(path.string()); !good.ok()) return good;
  if (absl::Status good = identity::CheckAuthorities(*pem); !good.ok()) return good;
  fs::path toml = path;
  toml.replace_extension(kToml);
  auto entry = ReadEntry(toml);
  if (!entry.ok()) return entry.status();
  if (absl::Status added = folder.rules.Add(*pem, entry->rule); !added.ok()) return added;
  if (!entry->crl_file.empty()) folder.lists.push_back({entry->crl_file, path.string()});
  folder.pems.append(pem->text).append("\n");
  return absl::OkStatus();
}

/// What Kubernetes mounts is open to everybody by its mode, and read-only.
bool IsReadOnly(const std::string& folder) {
  struct statvfs system {};
  return ::statvfs(folder.c_str(), &system) == 0 && (system.f_flag & ST_RDONLY) != 0;
}

/// Who may write the folder chooses whom the server trusts.
absl::Status CheckFolder(const std::string& folder) {
  struct stat status {};
  if (::stat(folder.c_str(), &status) != 0 || !S_ISDIR(status.st_mode)) {
    return Unfit(folder, "is no folder that can be read");
  }
  if ((status.st_mode & S_IWOTH) == 0 || IsReadOnly(folder)) return absl::OkStatus();
  return Unfit(folder, fmt::format("everybody on this machine may write it: chmod o-w {}", folder));
}

}  // namespace

absl::StatusOr<AuthorityFolder> ReadAuthorityFolder(const std::string& folder) {
  if (absl::Status good = CheckFolder(folder); !good.ok()) return good;
  std::error_code error;
  std::vector<fs::path> pems;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const fs::path& path = at->path();
    if (path.extension() == kPem && !path.filename().string().starts_with('.')) {
      pems.push_back(path);
    }
  }
  if (error) return Unfit(folder, error.message());
  if (pems.empty()) return Unfit(folder, "holds no NAME.pem");
  if (pems.size() > kAuthoritiesMax) {
    return Unfit(folder, fmt::format("holds more than {} authorities", kAuthoritiesMax));
  }
  std::ranges::sort(pems);
  AuthorityFolder read;
  for (const fs::path& path : pems) {
    if (absl::Status taken = Take(path, read); !taken.ok()) return taken;
  }
  return read;
}

}  // namespace uplink::config
