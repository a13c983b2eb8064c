#pragma once

#include <string>
#include <string_view>

namespace uplink::config {

/// `0.1.0`. Pure, as those below.
[[nodiscard]] std::string_view Version();
/// The commit that the program was built from, 8 hex digits or more; `unknown` where the build
/// found none, as in a tarball, and was told none (UPLINK_COMMIT).
[[nodiscard]] std::string_view Commit();
/// What --version prints behind the program's name: `0.1.0 (commit 1a2b3c4d)`.
[[nodiscard]] std::string VersionText();

}  // namespace uplink::config
