#pragma once

#include <cstddef>
#include <string>

#include "schema/cyberwave/judge.h"
#include "schema/cyberwave/topic_kinds.h"
#include "schema/limits.h"
#include "server/config/config.h"
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
[[nodiscard]] session::SessionLimits SessionLimitsOf(const config::Config& config,
                                                     const std::string& version);
/// `memory_max`: what the process may use; 0 if that is not known.
[[nodiscard]] std::size_t LiveBytesMaxOf(const config::LimitsConfig& limits,
                                         std::size_t memory_max);
[[nodiscard]] http::ConnectionsMax HttpConnectionsMaxOf(const config::Config& config);
/// `memory_max`: what the process may use; the transport gets half of it.
[[nodiscard]] transport::RelayOptions RelayOptionsOf(const config::Config& config,
                                                     std::size_t memory_max);
/// How one of the connections to the broker is made, which `mqtt.url` names. Only that for what is
/// durable has a session that the broker keeps; whether one is expected there is not known here.
/// A broker that says nothing is noticed before any twin counts as silent: a ping is due each
/// quarter of the time that a twin has, at most, and its answer within as much.
[[nodiscard]] mqtt::ClientSettings ClientSettingsOf(const config::Config& config,
                                                    cyberwave::Connection connection);
[[nodiscard]] cyberwave::JudgeTerms JudgeTermsOf(const config::CyberwaveConfig& cyberwave);
[[nodiscard]] log::Level LogLevelOf(config::LogLevel level);
[[nodiscard]] log::Format LogFormatOf(config::LogFormat format);

}  // namespace uplink::run
