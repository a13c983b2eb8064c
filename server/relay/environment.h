#pragma once

#include <functional>

#include <absl/status/status.h>

#include "server/config/config.h"

namespace uplink::relay {

/// The value of an environment variable; null if it is not set.
using EnvironmentLookup = std::function<const char*(const char*)>;

/// Refuses environments in which gRPC would run, but badly: a polling engine that costs three times
/// as much for each message (measured). kFailedPrecondition names variable and value.
[[nodiscard]] absl::Status CheckEnvironment(const EnvironmentLookup& lookup);

/// Makes TLS 1.3 the lowest version where the configuration asks for it. gRPC 1.51 has no setter;
/// it reads the list of TLS 1.2 suites from the environment, once. A list that holds only a suite
/// no certificate can serve leaves TLS 1.3 alone. It holds for the whole process.
///
/// Thread: main, before any other thread starts and before gRPC is used.
void ApplyTlsMinimum(config::TlsVersion minimum);

/// Keeps protobuf from printing a line of its own for every text of a frame that is not UTF-8: any
/// peer could fill the log with them. Process-wide; before the relay starts.
void SilenceProtobuf();

}  // namespace uplink::relay
