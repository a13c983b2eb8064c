#pragma once

#include <cstddef>
#include <string>

#include "schema/cyberwave/judge.h"
#include "schema/cyberwave/topic_kinds.h"
#include "schema/limits.h"
#include "server/config/config.h"
#include "server/fleet/entry.h"
#include "server/http/limits.h"
#include "server/ingest/allowances.h"
#include "server/journal/limits.h"
#include "server/log/logger.h"
#include "server/mqtt/settings.h"
#include "server/robot/presence.h"
#include "server/session/limits.h"
#include "server/transport/options.h"

namespace uplink::run {

// What the configuration means for each component. Pure.

[[nodiscard]] journal::JournalLimits JournalLimitsOf(const config::JournalConfig& journal);
[[nodiscard]] robot::PresenceLimits PresenceLimitsOf(const config::PresenceConfig& presence);
/// The same of twins, which have a timeout of their own.
[[nodiscard]] robot::PresenceLimits TwinPresenceLimitsOf(const config::Config& config);
[[nodiscard]] schema::JudgeLimits JudgeLimitsOf(const config::LimitsConfig& limits);
[[nodiscard]] ingest::Allowance AllowanceOf(const config::Config& config);
[[nodiscard]] fleet::EntryRules EntryRulesOf(const config::IdentityConfig& identity);
[[nodiscard]] session::SessionLimits SessionLimitsOf(const config::Config& config,
                                                     const std::string& version);
/// `memory_max`: what the process may use; 0 if that is not known.
[[nodiscard]] std::size_t LiveBytesMaxOf(const config::LimitsConfig& limits,
                                         std::size_t memory_max);
[[nodiscard]] http::ConnectionsMax HttpConnectionsMaxOf(const config::Config& config);
/// `memory_max`: what the process may use; the transport gets half of it.
[[nodiscard]] transport::RelayOptions RelayOptionsOf(const config::Config& config,
                                                     std::size_t memory_max);
/// The same of listen.fleet, which must be set.
[[nodiscard]] transport::RelayOptions FleetOptionsOf(const config::Config& config,
                                                     std::size_t memory_max);
/// How a connection to the broker is made. `mqtt.url` must be good. Only the durable connection
/// asks the broker to keep its session; whether the broker has one is not known here. A silent
/// broker is noticed before its twins count as offline: the next ping is due after a quarter of
/// cyberwave.presence_timeout at most, and its answer within the same time.
[[nodiscard]] mqtt::ClientSettings ClientSettingsOf(const config::Config& config,
                                                    cyberwave::Connection connection);
[[nodiscard]] cyberwave::JudgeTerms JudgeTermsOf(const config::CyberwaveConfig& cyberwave);
[[nodiscard]] log::Level LogLevelOf(config::LogLevel level);
[[nodiscard]] log::Format LogFormatOf(config::LogFormat format);

}  // namespace uplink::run
