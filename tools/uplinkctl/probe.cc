#include "tools/uplinkctl/probe.h"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <system_error>

#include <fmt/core.h>

namespace uplink::ctl {
namespace {

constexpr std::string_view kScheme = "http://";

/// The start of a foreign text, on one line.
std::string Shown(std::string_view text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.remove_suffix(1);
  std::string shown(text.substr(0, kProbeShownMax));
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return shown;
}

bool IsPort(std::string_view text) {
  unsigned port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  return error == std::errc() && end == text.data() + text.size() && port > 0 && port < 65'536;
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

absl::StatusOr<std::string> AddressOfUrl(const std::string& url, const std::string& named) {
  std::string_view rest = url;
  const auto wrong = [&](const char* why) {
    return absl::InvalidArgumentError(fmt::format(
        "{} \"{}\": {}; it is http://HOST:PORT, an IPv6 host in brackets", named, url, why));
  };
  if (!rest.starts_with(kScheme)) return wrong("it does not begin with http://");
  rest.remove_prefix(kScheme.size());
  if (rest.ends_with('/')) rest.remove_suffix(1);
  if (rest.find_first_of("/?#@ ") != std::string_view::npos) return wrong("it has more than that");
  const std::size_t bracket = rest.rfind(']');
  const std::size_t colon = rest.find(':', bracket == std::string_view::npos ? 0 : bracket);
  const std::string_view host = rest.substr(0, colon);
  if (host.empty() || host == "[]") return wrong("it has no host");
  if ((host.front() == '[') != (host.back() == ']')) return wrong("its brackets do not match");
  if (colon == std::string_view::npos) return std::string(host) + ":80";
  if (!IsPort(rest.substr(colon + 1))) return wrong("its port is none");
  return std::string(rest);
}

}  // namespace uplink::ctl
