#pragma once

#include <cstddef>
#include <string>

#include "schema/judge.h"
#include "server/config/config.h"
#include "server/journal/limits.h"
#include "server/log/logger.h"
#include "server/robot/presence.h"
#include "server/session/allowances.h"
#include "server/session/limits.h"
#include "server/transport/options.h"

namespace uplink::lifecycle {

// What the configuration means for each component. Pure.

[[nodiscard]] journal::JournalLimits JournalLimitsOf(const config::JournalConfig& journal);
[[nodiscard]] robot::PresenceLimits PresenceLimitsOf(const config::PresenceConfig& presence);
[[nodiscard]] schema::JudgeLimits JudgeLimitsOf(const config::LimitsConfig& limits);
[[nodiscard]] session::Allowance AllowanceOf(const config::Config& config);
[[nodiscard]] session::SessionLimits SessionLimitsOf(const config::Config& config,
                                                     const std::string& version);
/// `memory_max`: what the process may use; the transport gets half of it.
[[nodiscard]] transport::RelayOptions RelayOptionsOf(const config::Config& config,
                                                     std::size_t memory_max);
[[nodiscard]] log::Level LogLevelOf(config::LogLevel level);
[[nodiscard]] log::Format LogFormatOf(config::LogFormat format);

}  // namespace uplink::lifecycle
