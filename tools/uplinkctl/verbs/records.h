#pragma once

#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <boost/json.hpp>

#include "server/config/flags.h"
#include "tools/uplinkctl/ask/api.h"
#include "tools/uplinkctl/verbs/common.h"

// Verbs that show one thing whole.
namespace uplink::ctl {

// verbs/status.cc
void AddStatus(config::Flags& program);
/// The answer of /api/v1/status as a page for people. Pure; any thread.
[[nodiscard]] std::string StatusText(const boost::json::object& status, const RowTerms& terms);

// verbs/robots_get.cc
void AddRobotsGet(config::Flags& noun);

// verbs/missions_show.cc
void AddMissionsShow(config::Flags& noun);
/// One run with its reports. Errors: kNotFound if the store has no such run; those of Api.
[[nodiscard]] absl::StatusOr<std::string> MissionText(const std::string& run,
                                                      const std::string& robot, Format format,
                                                      Api& api, const Screen& screen);

// verbs/quarantine_show.cc
void AddQuarantineShow(config::Flags& noun);

// verbs/config_show.cc
void AddConfigShow(config::Flags& noun);

}  // namespace uplink::ctl
