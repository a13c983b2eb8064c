#include "server/store/process_life.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>
#include <vector>

#include <absl/strings/numbers.h>
#include <absl/strings/str_split.h>
#include <climits>
#include <fmt/format.h>
#include <unistd.h>

#include "server/config/load.h"

namespace uplink::store {
namespace {

/// The field of /proc/PID/stat, after the closing bracket of the name, that says when the process
/// started.
constexpr std::size_t kStartField = 19;

std::string FirstLine(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

/// The namespace that two processes share if they see the same process numbers; empty if unknown.
std::string Surroundings() {
  const std::string boot =
      BootId(FirstLine("/proc/sys/kernel/random/boot_id"), config::BootIdOfManager());
  std::error_code error;
  const auto numbers = std::filesystem::read_symlink("/proc/self/ns/pid", error);
  if (boot.empty() || error) return "";
  return boot + "/" + numbers.string();
}

enum class State : std::uint8_t { kRuns, kEnded, kHidden };

/// The visible state of a process.
struct Seen {
  State state = State::kHidden;
  /// Clock ticks from the boot to its start, if it runs.
  std::string start;
};

Seen Look(std::string_view process) {
  const std::string stat = FirstLine(fmt::format("/proc/{}/stat", process));
  const std::size_t name_end = stat.rfind(')');
  if (name_end == std::string::npos || name_end + 2 > stat.size()) return {};
  const std::vector<std::string> fields = absl::StrSplit(stat.substr(name_end + 2), ' ');
  if (fields.size() <= kStartField) return {};
  // A process that has ended and was not waited for yet does nothing any more.
  if (fields[0] == "Z" || fields[0] == "X") return {.state = State::kEnded, .start = {}};
  return {.state = State::kRuns, .start = fields[kStartField]};
}

}  // namespace

std::string BootId(std::string_view from_kernel, std::string_view from_manager) {
  std::string boot(from_kernel.empty() ? from_manager : from_kernel);
  std::erase(boot, '-');
  return boot;
}

std::string LifeOfThisProcess() {
  const std::string surroundings = Surroundings();
  const std::string number = std::to_string(::getpid());
  const std::string start = Look(number).start;
  if (surroundings.empty() || start.empty()) return "";
  return fmt::format("{}/{}/{}", surroundings, number, start);
}

bool IsGone(std::string_view life) {
  const std::string surroundings = Surroundings();
  if (surroundings.empty() || !life.starts_with(surroundings + "/")) return false;
  life.remove_prefix(surroundings.size() + 1);
  const std::size_t slash = life.find('/');
  if (slash == std::string_view::npos) return false;
  const std::string_view number = life.substr(0, slash);
  int parsed = 0;
  if (!absl::SimpleAtoi(absl::string_view(number.data(), number.size()), &parsed)) return false;
  if (parsed <= 0) return false;
  switch (const Seen seen = Look(number); seen.state) {
    case State::kRuns:
      return seen.start != life.substr(slash + 1);
    case State::kEnded:
      return true;
    case State::kHidden:
      // It may be another user's: only the kernel's own word counts then.
      return ::kill(parsed, 0) != 0 && errno == ESRCH;
  }
  return false;
}

std::string HostName() {
  std::array<char, HOST_NAME_MAX + 1> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0 || name[0] == 0) return "localhost";
  return name.data();
}

}  // namespace uplink::store
