#pragma once

#include <string>
#include <vector>

#include <absl/status/statusor.h>
#include <boost/json.hpp>

#include "server/config/flags.h"

// Verbs that change what operators decide.
namespace uplink::ctl {

/// `robots block`, `unblock`, `disconnect`, `note` and `add`.
void AddRobotCommands(config::Flags& noun);
/// `faults acknowledge`.
void AddFaultCommands(config::Flags& noun);
/// `certificates list`, `revoke` and `unrevoke`.
void AddCertificateCommands(config::Flags& noun);
/// `reload`.
void AddReload(config::Flags& program);

/// `NAME=VALUE` of each as one object; `NAME=` removes the label.
///
/// Errors: kInvalidArgument for a text without `=`.
[[nodiscard]] absl::StatusOr<boost::json::object> LabelsOf(const std::vector<std::string>& labels);

}  // namespace uplink::ctl
