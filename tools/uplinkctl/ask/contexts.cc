#include "tools/uplinkctl/ask/contexts.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <toml++/toml.h>
#include <unistd.h>

#include "schema/base/file_text.h"
#include "schema/base/utf8.h"
#include "schema/base/write_all.h"
#include "tools/terminal/terminal.h"
#include "tools/uplinkctl/ask/server_url.h"

namespace uplink::ctl {
namespace {

constexpr std::string_view kBelow = "/uplinkctl/config.toml";

absl::Status Wrong(const std::string& path, const std::string& why) {
  return absl::InvalidArgumentError(fmt::format("{}: {}", path, why));
}

absl::Status WrongKey(const std::string& path, const std::string& key, const char* known) {
  return Wrong(path, fmt::format("{}: unknown key; it takes {}, and no secrets", key, known));
}

/// The files of a context, by their keys.
constexpr std::pair<std::string_view, std::string AccessFiles::*> kFiles[] = {
    {"ca_file", &AccessFiles::ca_file},
    {"certificate_file", &AccessFiles::certificate_file},
    {"key_file", &AccessFiles::key_file},
    {"token_file", &AccessFiles::token_file},
};
constexpr const char* kKnownKeys = "server, ca_file, certificate_file, key_file and token_file";

/// A path that TOML holds as Quoted writes it.
bool IsPlain(const std::string& text) {
  return IsCleanUtf8(text) && std::ranges::none_of(text, [](char c) {
           const auto byte = static_cast<unsigned char>(c);
           return byte < 0x20 || byte == 0x7f;
         });
}

/// A string of TOML; without control characters there is nothing else to escape.
std::string Quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

absl::StatusOr<Context> ReadContext(const std::string& name, const toml::node& node,
                                    const std::string& path) {
  const std::string key = "contexts." + name;
  if (absl::Status good = CheckContextName(name); !good.ok()) {
    return Wrong(path, std::string(good.message()));
  }
  const toml::table* table = node.as_table();
  if (table == nullptr) return Wrong(path, key + ": it must be a table");
  Context context;
  for (const auto& [member, value] : *table) {
    const std::string_view called = member.str();
    const auto* const file =
        std::ranges::find_if(kFiles, [called](const auto& each) { return each.first == called; });
    if (called != "server" && file == std::end(kFiles)) {
      return WrongKey(path, fmt::format("{}.{}", key, called), kKnownKeys);
    }
    std::string& into = file == std::end(kFiles) ? context.server : context.files.*(file->second);
    into = value.value_or(std::string());
  }
  absl::StatusOr<Context> good = GoodContext(std::move(context), key + ".server");
  if (!good.ok()) return Wrong(path, std::string(good.status().message()));
  return good;
}

absl::Status Failed(const std::string& path) {
  return absl::InternalError(fmt::format("{}: {}", path, std::generic_category().message(errno)));
}

absl::Status WriteNew(const std::string& path, const std::string& text) {
  const int file =
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (file < 0) return Failed(path);
  const bool written = WriteAll(file, text, {}) == Written::kAll && ::fsync(file) == 0;
  absl::Status status = written ? absl::OkStatus() : Failed(path);
  ::close(file);
  return status;
}

}  // namespace

std::string ContextsFile(const char* const* environment) {
  const std::string_view configured = VariableIn(environment, "XDG_CONFIG_HOME");
  // The specification of the variable ignores one that is not absolute.
  if (configured.starts_with('/')) return std::string(configured) + std::string(kBelow);
  const std::string_view home = VariableIn(environment, "HOME");
  return home.empty() ? std::string() : std::string(home) + "/.config" + std::string(kBelow);
}

absl::Status CheckContextName(const std::string& name) {
  const bool plain = std::ranges::all_of(name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_';
  });
  if (plain && !name.empty() && name.size() <= kContextNameMax) return absl::OkStatus();
  return absl::InvalidArgumentError(fmt::format(
      "context \"{}\": a name has letters, digits, - and _, at most {}", name, kContextNameMax));
}

absl::StatusOr<Context> GoodContext(Context context, const std::string& key) {
  const absl::StatusOr<ServerUrl> url = ParseServerUrl(context.server, key);
  if (!url.ok()) return url.status();
  if (!IsPlain(context.server)) {
    return absl::InvalidArgumentError(key + ": it has a control character");
  }
  for (const auto& [name, member] : kFiles) {
    std::string& file = context.files.*member;
    if (file.empty()) continue;
    if (!IsPlain(file)) {
      return absl::InvalidArgumentError(
          fmt::format("{}: it has a control character, or is no UTF-8", name));
    }
    std::error_code error;
    const std::filesystem::path absolute = std::filesystem::absolute(file, error);
    if (error) return absl::InvalidArgumentError(fmt::format("{}: {}", file, error.message()));
    file = absolute.lexically_normal().string();
  }
  if (absl::Status good = CheckAccess(*url, context.files); !good.ok()) return good;
  return context;
}

absl::StatusOr<Contexts> ParseContexts(const std::string& text, const std::string& path) {
  Contexts contexts;
  toml::table table;
  try {
    table = toml::parse(text, path);
  } catch (const toml::parse_error& error) {
    return absl::InvalidArgumentError(
        fmt::format("{}:{}: {}", path, error.source().begin.line, error.description()));
  }
  for (const auto& [key, value] : table) {
    if (key.str() == "current") {
      contexts.current = value.value_or(std::string());
      continue;
    }
    const toml::table* named = value.as_table();
    if (key.str() != "contexts" || named == nullptr) {
      return WrongKey(path, std::string(key.str()), "current and [contexts.NAME]");
    }
    for (const auto& [name, each] : *named) {
      absl::StatusOr<Context> context = ReadContext(std::string(name.str()), each, path);
      if (!context.ok()) return context.status();
      contexts.by_name.emplace(name.str(), *std::move(context));
    }
  }
  if (!contexts.current.empty() && !contexts.by_name.contains(contexts.current)) {
    return Wrong(path, fmt::format("current is {}, which is none of [contexts]", contexts.current));
  }
  return contexts;
}

absl::StatusOr<Contexts> LoadContexts(const std::string& path) {
  std::error_code error;
  if (path.empty() || !std::filesystem::exists(path, error)) return Contexts{};
  const FileText file = ReadFileText(path, kContextsBytesMax);
  if (!file.problem.empty()) return Wrong(path, file.problem);
  return ParseContexts(file.text, path);
}

std::string ContextsText(const Contexts& contexts) {
  std::string text = "# Servers that uplinkctl knows; uplinkctl contexts --help\n";
  if (!contexts.current.empty()) text += fmt::format("current = \"{}\"\n", contexts.current);
  for (const auto& [name, context] : contexts.by_name) {
    text += fmt::format("\n[contexts.{}]\nserver = {}\n", name, Quoted(context.server));
    for (const auto& [key, member] : kFiles) {
      const std::string& file = context.files.*member;
      if (!file.empty()) text += fmt::format("{} = {}\n", key, Quoted(file));
    }
  }
  return text;
}

absl::Status SaveContexts(const Contexts& contexts, const std::string& path) {
  if (path.empty()) {
    return absl::FailedPreconditionError(
        "neither XDG_CONFIG_HOME nor HOME is set: there is no place for contexts");
  }
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return absl::InternalError(fmt::format("{}: {}", folder.string(), error.message()));
  const std::string aside = path + ".new";
  if (absl::Status written = WriteNew(aside, ContextsText(contexts)); !written.ok()) return written;
  if (::rename(aside.c_str(), path.c_str()) != 0) return Failed(path);
  return absl::OkStatus();
}

}  // namespace uplink::ctl
