#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

#include "schema/base/clock.h"
#include "tools/link/http_client.h"

namespace uplink::ctl {

/// How long a probe may take from its connect to the last byte of the answer. Less than what waits
/// for it: 7 s in the chart, 10 s in the image and the compose files, so that uplinkctl says why.
inline constexpr milliseconds kProbeDeadline = std::chrono::seconds(5);
/// Bytes of an answer that are read, and those that are shown.
inline constexpr std::size_t kProbeBytesMax = std::size_t{16} * 1024;
inline constexpr std::size_t kProbeShownMax = 300;

enum class Probe : std::uint8_t { kAlive, kReady };

/// What a server's answer to a probe says. A value.
struct ProbeWord {
  bool good = false;
  /// One line for people, without control characters.
  std::string line;
};

/// `/livez` or `/readyz`.
[[nodiscard]] std::string ProbePath(Probe probe);

/// A pure function. An answer of 200 is good only in the server's own words: another program may
/// have taken the port.
[[nodiscard]] ProbeWord JudgeAnswer(Probe probe, const link::HttpAnswer& answer);

}  // namespace uplink::ctl
