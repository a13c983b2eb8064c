#include "tools/uplinkctl/doctor/service_user.h"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <system_error>

#include <fmt/core.h>
#include <grp.h>
#include <pwd.h>
#include <unistd.h>

namespace uplink::ctl {
namespace {

/// Bytes of one user's line and its fields.
constexpr std::size_t kEntryBytesMax = 16'384;

User UserOf(const passwd& entry) {
  return {entry.pw_name, entry.pw_uid, entry.pw_gid, entry.pw_dir == nullptr ? "" : entry.pw_dir};
}

absl::Status Refused(const char* step, const User& user) {
  return absl::InternalError(fmt::format("cannot become {}: {}: {}", user.name, step,
                                         std::generic_category().message(errno)));
}

}  // namespace

std::optional<User> FindUser(const std::string& name) {
  passwd entry{};
  passwd* found = nullptr;
  std::array<char, kEntryBytesMax> buffer{};
  if (::getpwnam_r(name.c_str(), &entry, buffer.data(), buffer.size(), &found) != 0 ||
      found == nullptr) {
    return std::nullopt;
  }
  return UserOf(entry);
}

User CurrentUser() {
  const uid_t uid = ::geteuid();
  passwd entry{};
  passwd* found = nullptr;
  std::array<char, kEntryBytesMax> buffer{};
  if (::getpwuid_r(uid, &entry, buffer.data(), buffer.size(), &found) == 0 && found != nullptr) {
    return UserOf(entry);
  }
  return {fmt::format("user id {}", uid), uid, ::getegid(), {}};
}

absl::StatusOr<User> UserToCheckAs(const std::string& asked) {
  const User current = CurrentUser();
  if (asked.empty()) {
    if (current.uid != 0) return current;
    return FindUser(kServiceUser).value_or(current);
  }
  const std::optional<User> user = FindUser(asked);
  if (!user) return absl::InvalidArgumentError(fmt::format("--user {}: no such user", asked));
  if (user->uid != current.uid && current.uid != 0) {
    return absl::InvalidArgumentError(
        fmt::format("--user {}: only root can look as another user", asked));
  }
  return *user;
}

absl::Status Become(const User& user) {
  if (user.uid == ::geteuid()) return absl::OkStatus();
  if (::initgroups(user.name.c_str(), user.gid) != 0) return Refused("groups", user);
  if (::setresgid(user.gid, user.gid, user.gid) != 0) return Refused("group", user);
  if (::setresuid(user.uid, user.uid, user.uid) != 0) return Refused("user", user);
  // NOLINTNEXTLINE(concurrency-mt-unsafe): no other thread has begun
  ::setenv("HOME", user.home.c_str(), 1);
  return absl::OkStatus();
}

}  // namespace uplink::ctl
