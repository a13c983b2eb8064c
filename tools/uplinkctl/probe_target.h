#pragma once

#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "server/config/load.h"
#include "tools/uplinkctl/ask/server_url.h"

namespace uplink::ctl {

/// Which server a probe asks. A value.
struct ProbeTarget {
  ServerUrl url;
  /// Where the address comes from, for people: `listen.http of /etc/uplinkd/uplinkd.toml`.
  std::string source;
  /// The certificate that the server's configuration names; empty: it names none.
  std::string certificate_file = {};
};

/// Errors: kInvalidArgument for what is no URL of a server.
[[nodiscard]] absl::StatusOr<ProbeTarget> TargetOfUrl(const std::string& url);

/// The server of that configuration file, with the variables of `environment` over it.
///
/// Errors: kInvalidArgument if the file cannot be read, or lets the server take any free port.
[[nodiscard]] absl::StatusOr<ProbeTarget> TargetOfConfig(const std::string& path,
                                                         const config::Environment& environment);

/// The server of the file at `usual` if this user may read it; else one that has the defaults and
/// the variables of `environment`.
///
/// Errors: as TargetOfConfig.
[[nodiscard]] absl::StatusOr<ProbeTarget> TargetWithoutFlags(
    const std::string& usual, const config::Environment& environment);

/// The status of a probe that got no answer, with the source of the address.
[[nodiscard]] absl::Status WithSource(const absl::Status& status, const ProbeTarget& target);

}  // namespace uplink::ctl
