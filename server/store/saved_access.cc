#include "server/store/saved_access.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "schema/base/file_text.h"

namespace uplink::store {
namespace {

constexpr std::string_view kHead = "uplinkd access 1";
constexpr std::string_view kStore = "store ";
constexpr std::string_view kVersion = "version ";
constexpr std::string_view kRevoked = "revoked ";
constexpr std::string_view kBlocked = "blocked ";
constexpr std::string_view kAdded = "added ";
/// Lines before the first of these: the head, the store, the version.
constexpr std::size_t kLinesBefore = 3;
/// The last line says how many lines stand before it.
constexpr std::string_view kEnd = "end ";

/// Owner reads and writes.
constexpr mode_t kMode = 0600;

bool FitsALine(std::string_view text) {
  return !text.empty() && text.find_first_of(std::string_view("\n\0", 2)) == std::string::npos;
}

/// Takes the first line off; nothing if none is whole.
std::optional<std::string_view> TakeLine(std::string_view& text) {
  const std::size_t end = text.find('\n');
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end + 1);
  return line;
}

bool TakeWord(std::string_view& line, std::string_view word) {
  if (!line.starts_with(word)) return false;
  line.remove_prefix(word.size());
  return true;
}

static_assert(storage::kAllRevokedBy.size() <= 10, "a line has one digit for the kind");

constexpr char DigitOf(storage::RevokedBy by) {
  return static_cast<char>('0' + static_cast<int>(by));
}

std::optional<storage::Revocation> RevocationIn(std::string_view line) {
  if (line.size() < 3 || line[1] != ' ') return std::nullopt;
  for (const storage::RevokedBy by : storage::kAllRevokedBy) {
    if (line[0] != DigitOf(by)) continue;
    storage::Revocation revocation;
    revocation.by = by;
    revocation.value = line.substr(2);
    return revocation;
  }
  return std::nullopt;
}

/// Nothing: the line is none of a copy.
bool Take(std::string_view line, AccessCopy& copy) {
  if (TakeWord(line, kRevoked)) {
    auto revocation = RevocationIn(line);
    if (!revocation) return false;
    copy.revocations.push_back(*std::move(revocation));
    return true;
  }
  const bool blocked = TakeWord(line, kBlocked);
  if (!blocked && !TakeWord(line, kAdded)) return false;
  // A robot that is both has two lines, one after the other.
  if (!copy.settings.empty() && copy.settings.back().ruri == line) {
    copy.settings.back().registered = true;
    return !blocked;
  }
  storage::RobotSetting setting;
  setting.ruri = line;
  setting.blocked = blocked;
  setting.registered = !blocked;
  copy.settings.push_back(std::move(setting));
  return true;
}

absl::Status NotWhole() { return absl::FailedPreconditionError("it is damaged: not whole"); }

absl::Status Failed(const std::string& path, const char* what) {
  return absl::UnavailableError(
      fmt::format("{}: {}: {}", path, what, std::generic_category().message(errno)));
}

/// Closes what it holds.
class File final {
 public:
  explicit File(int descriptor) : descriptor_(descriptor) {}
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  [[nodiscard]] int get() const { return descriptor_; }

 private:
  const int descriptor_;
};

bool WriteWhole(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(file, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

std::size_t LackedBy(const AllAccess& store, const AccessCopy& known) {
  std::map<std::pair<storage::RevokedBy, std::string_view>, const storage::Revocation*> revocations;
  for (const storage::Revocation& each : store.revocations) {
    revocations[{each.by, each.value}] = &each;
  }
  std::map<std::string_view, const storage::RobotSetting*> settings;
  for (const storage::RobotSetting& each : store.settings) settings[each.ruri] = &each;
  // What was decided otherwise since has a later version.
  const auto lacks_revocation = [&](const storage::Revocation& each) {
    const auto row = revocations.find({each.by, each.value});
    if (row == revocations.end()) return true;
    return !row->second->revoked && row->second->version <= known.version;
  };
  const auto lacks_setting = [&](const storage::RobotSetting& each) {
    const auto row = settings.find(each.ruri);
    if (row == settings.end()) return true;
    const storage::RobotSetting& now = *row->second;
    const bool undone = (each.blocked && !now.blocked) || (each.registered && !now.registered);
    return undone && now.version <= known.version;
  };
  return static_cast<std::size_t>(std::ranges::count_if(known.revocations, lacks_revocation) +
                                  std::ranges::count_if(known.settings, lacks_setting));
}

std::string TextOf(const AccessCopy& copy, const std::string& store) {
  std::string text = fmt::format("{}\n{}{}\n{}{}\n", kHead, kStore, store, kVersion, copy.version);
  std::size_t lines = kLinesBefore;
  const auto add = [&text, &lines](std::string_view word, std::string_view rest) {
    text.append(word).append(rest).append("\n");
    ++lines;
  };
  for (const storage::Revocation& each : copy.revocations) {
    if (!each.revoked || !FitsALine(each.value)) continue;
    add(kRevoked, fmt::format("{} {}", DigitOf(each.by), each.value));
  }
  for (const storage::RobotSetting& each : copy.settings) {
    if (!FitsALine(each.ruri)) continue;
    if (each.blocked) add(kBlocked, each.ruri);
    if (each.registered) add(kAdded, each.ruri);
  }
  return text + fmt::format("{}{}\n", kEnd, lines);
}

absl::StatusOr<AccessCopy> ParseAccess(const std::string& text, const std::string& store) {
  std::string_view rest = text;
  if (TakeLine(rest) != kHead) {
    return absl::FailedPreconditionError("it is no copy that this version has saved");
  }
  auto line = TakeLine(rest);
  if (!line || !TakeWord(*line, kStore)) return NotWhole();
  if (*line != store) {
    return absl::FailedPreconditionError(fmt::format("it is of another store: {}", *line));
  }
  AccessCopy copy;
  line = TakeLine(rest);
  if (!line || !TakeWord(*line, kVersion)) return NotWhole();
  std::from_chars(line->data(), line->data() + line->size(), copy.version);
  std::size_t lines = kLinesBefore;
  while ((line = TakeLine(rest))) {
    if (TakeWord(*line, kEnd)) {
      std::size_t said = 0;
      std::from_chars(line->data(), line->data() + line->size(), said);
      if (said != lines || !rest.empty()) return NotWhole();
      return copy;
    }
    if (!Take(*line, copy)) return NotWhole();
    ++lines;
  }
  return NotWhole();
}

absl::Status SaveAccess(const std::string& path, const std::string& text) {
  const std::string aside = path + ".new";
  {
    // What an earlier process left may have another mode.
    ::unlink(aside.c_str());
    const File file(::open(aside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kMode));
    if (file.get() < 0) return Failed(aside, "cannot be made");
    if (!WriteWhole(file.get(), text) || ::fsync(file.get()) != 0) {
      absl::Status failed = Failed(aside, "cannot be written");
      ::unlink(aside.c_str());
      return failed;
    }
  }
  if (std::rename(aside.c_str(), path.c_str()) == 0) return absl::OkStatus();
  absl::Status failed = Failed(path, "cannot be replaced");
  ::unlink(aside.c_str());
  return failed;
}

absl::StatusOr<std::string> ReadSavedAccess(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    return absl::NotFoundError(fmt::format("{}: there is none", path));
  }
  if ((status.st_mode & (S_IWGRP | S_IWOTH)) != 0) {
    return absl::FailedPreconditionError(
        fmt::format("{}: others than its owner may write it: chmod go-w {}", path, path));
  }
  FileText file = ReadFileText(path, kSavedAccessBytesMax);
  if (file.problem.empty()) return std::move(file.text);
  return absl::FailedPreconditionError(fmt::format("{}: {}", path, file.problem));
}

}  // namespace uplink::store
