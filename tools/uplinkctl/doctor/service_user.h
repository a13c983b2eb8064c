#pragma once

#include <optional>
#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <sys/types.h>

namespace uplink::ctl {

/// The user who runs the server, unless --user names another.
inline constexpr const char* kServiceUser = "uplinkd";

/// A user of this machine. A value.
struct User {
  std::string name;
  uid_t uid = 0;
  gid_t gid = 0;
  std::string home;
};

/// Nothing if there is none of that name.
[[nodiscard]] std::optional<User> FindUser(const std::string& name);

/// Who this process is.
[[nodiscard]] User CurrentUser();

/// As whom the server's files are looked at: `asked` if it is given, else the service user if we
/// are root and there is one, else who we are.
///
/// Errors: kInvalidArgument if there is no such user, or we may not become them.
[[nodiscard]] absl::StatusOr<User> UserToCheckAs(const std::string& asked);

/// Becomes that user for good, with their groups and their home folder, where libpq looks for a
/// password. Nothing happens if we are them.
///
/// Errors: kInternal if the system refuses a step.
[[nodiscard]] absl::Status Become(const User& user);

}  // namespace uplink::ctl
