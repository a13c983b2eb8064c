#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "tools/uplinkctl/ask/api.h"

namespace uplink::ctl {

/// Robots that an error of an ambiguous name lists.
inline constexpr std::size_t kCandidatesShown = 8;

/// Robots among which short names are unique: as many as a server has by default.
inline constexpr std::size_t kNamedRobotsMax = 20'000;

/// The RURI that a name means: itself if it is one; else that of the one robot whose last segment,
/// or last two, the name is.
///
/// Errors: kNotFound if there is no such robot, with those that are alike; kInvalidArgument if
///         there are several, with them; those of Api.
[[nodiscard]] absl::StatusOr<std::string> ResolveRobot(Api& api, const std::string& name);
/// Each of them.
[[nodiscard]] absl::StatusOr<std::vector<std::string>> ResolveRobots(
    Api& api, const std::vector<std::string>& names);

/// RURIs of the server's robots, kNamedRobotsMax at most: what a short name must tell apart. None
/// where the server does not answer: rows are worth showing without.
[[nodiscard]] std::vector<std::string> RobotsOf(Api& api);

}  // namespace uplink::ctl
