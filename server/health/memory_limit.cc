#include "server/health/memory_limit.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <optional>
#include <sstream>
#include <string_view>
#include <system_error>

namespace uplink::health {
namespace {

/// One of the two kinds of hierarchy that bound memory.
struct Hierarchy {
  /// The type of its mount.
  std::string_view type;
  /// The controller that its line and its mount name; empty: none does (version 2).
  std::string_view controller;
  /// The file of a group that holds its limit.
  std::string_view file;
};

constexpr Hierarchy kVersion2{"cgroup2", "", "memory.max"};
constexpr Hierarchy kVersion1{"cgroup", "memory", "memory.limit_in_bytes"};

/// A mount of a hierarchy: its group `root` is at the folder `folder`.
struct Mount {
  std::string root;
  std::string folder;
};

bool Holds(std::string_view list, std::string_view word) {
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    if (list.substr(0, comma) == word) return true;
    list.remove_prefix(std::min(comma + 1, list.size()));
  }
  return false;
}

/// The group of this process, from lines `id:controllers:path`.
std::optional<std::string> GroupOf(const std::string& file, const Hierarchy& hierarchy) {
  std::ifstream lines(file);
  std::string line;
  while (std::getline(lines, line)) {
    const std::size_t first = line.find(':');
    const std::size_t second = first == std::string::npos ? first : line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string_view names = std::string_view(line).substr(first + 1, second - first - 1);
    const bool is_it =
        hierarchy.controller.empty() ? line.starts_with("0::") : Holds(names, hierarchy.controller);
    if (is_it) return line.substr(second + 1);
  }
  return std::nullopt;
}

/// A path of a table of mounts, which writes blanks as `\040`.
std::string Unescaped(std::string_view text) {
  std::string path;
  while (!text.empty()) {
    unsigned code = 0;
    const bool escaped =
        text.size() >= 4 && text.front() == '\\' &&
        std::from_chars(text.data() + 1, text.data() + 4, code, 8).ptr == text.data() + 4;
    path += escaped ? static_cast<char>(code) : text.front();
    text.remove_prefix(escaped ? 4 : 1);
  }
  return path;
}

/// The mount in a line `id parent device root folder options fields... - type source options`, if
/// it is of the hierarchy.
std::optional<Mount> MountOf(const std::string& line, const Hierarchy& hierarchy) {
  const std::size_t dash = line.find(" - ");
  if (dash == std::string::npos) return std::nullopt;
  std::istringstream behind(line.substr(dash + 3));
  std::string type;
  std::string source;
  std::string options;
  behind >> type >> source >> options;
  if (type != hierarchy.type) return std::nullopt;
  if (!hierarchy.controller.empty() && !Holds(options, hierarchy.controller)) return std::nullopt;
  std::istringstream before(line);
  std::string skipped;
  std::string root;
  std::string folder;
  before >> skipped >> skipped >> skipped >> root >> folder;
  return Mount{Unescaped(root), Unescaped(folder)};
}

std::optional<Mount> FindMount(const std::string& file, const Hierarchy& hierarchy) {
  std::ifstream lines(file);
  std::string line;
  for (std::size_t i = 0; i < kMountLinesMax && std::getline(lines, line); ++i) {
    if (auto mount = MountOf(line, hierarchy)) return mount;
  }
  return std::nullopt;
}

/// The group's path below the mount, with a leading slash. Empty for the mount's own group, and for
/// a group outside the mount, as in a container that sees only its own groups.
std::string BelowMount(const std::string& group, const std::string& root) {
  const std::string prefix = root == "/" ? std::string() : root;
  if (!group.starts_with(prefix + "/") || group.find("/..") != std::string::npos) return {};
  const std::string below = group.substr(prefix.size());
  return below == "/" ? std::string() : below;
}

/// The number at the start of the file, or `otherwise`: version 2 has `max` there for no limit.
std::size_t LimitIn(const std::string& file, std::size_t otherwise) {
  std::ifstream text(file);
  std::size_t limit = 0;
  return text >> limit && limit > 0 ? limit : otherwise;
}

std::size_t LeastOf(const Hierarchy& hierarchy, const GroupFiles& files, std::size_t least) {
  const auto group = GroupOf(files.groups, hierarchy);
  const auto mount = FindMount(files.mounts, hierarchy);
  if (!group || !mount) return least;
  std::string below = BelowMount(*group, mount->root);
  while (true) {
    const std::string folder = mount->folder + below + "/";
    least = std::min(least, LimitIn(folder + std::string(hierarchy.file), least));
    if (below.empty()) return least;
    below.resize(below.rfind('/'));
  }
}

}  // namespace

std::size_t MemoryLimit(const GroupFiles& files, std::size_t machine_bytes) {
  return LeastOf(kVersion1, files, LeastOf(kVersion2, files, machine_bytes));
}

}  // namespace uplink::health
