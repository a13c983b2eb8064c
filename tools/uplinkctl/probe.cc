#include "tools/uplinkctl/probe.h"

#include <algorithm>
#include <string_view>

#include <fmt/core.h>

namespace uplink::ctl {
namespace {

/// The start of a foreign text, on one line.
std::string Shown(std::string_view text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.remove_suffix(1);
  std::string shown(text.substr(0, kProbeShownMax));
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return shown;
}

}  // namespace

std::string ProbePath(Probe probe) { return probe == Probe::kReady ? "/readyz" : "/livez"; }

ProbeWord JudgeAnswer(Probe probe, const link::HttpAnswer& answer) {
  const bool asks_ready = probe == Probe::kReady;
  const std::string_view what = asks_ready ? "ready" : "alive";
  const std::string words = Shown(answer.body);
  const auto says = [&](std::string_view member) {
    return answer.body.starts_with(fmt::format("{{\"{}\":", member));
  };
  if (answer.status == 200 && says(asks_ready ? "degraded" : "relayLastHandshakeSeconds")) {
    return {true, fmt::format("{}: {}", what, words)};
  }
  if (answer.status == 503 && says(asks_ready ? "refuses" : "relayLastHandshakeSeconds")) {
    return {false, fmt::format("not {}: {}", what, words)};
  }
  return {false, fmt::format("not {}: {} answers {}, and not as uplinkd does: {}", what,
                             ProbePath(probe), answer.status, words)};
}

}  // namespace uplink::ctl
