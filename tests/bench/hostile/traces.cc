#include "tests/bench/hostile/traces.h"

#include <algorithm>
#include <array>

#include <fmt/core.h>

#include "tests/bench/hostile/attack.h"
#include "tests/support/tcp_crowd.h"

namespace uplink::bench {
namespace {

/// The transport's and the sessions'. That a handshake failed is counted too, and says less.
constexpr std::array<std::string_view, 6> kTraces = {"uplinkd_connections_turned_away_total",
                                                     "uplinkd_streams_refused_total",
                                                     "uplinkd_protocol_errors_total",
                                                     "uplinkd_peer_stalls_total",
                                                     "uplinkd_held_back_total",
                                                     "uplinkd_handshakes_failed_total"};

/// `TIME LEVEL EVENT ...`
bool IsWarning(std::string_view line) {
  const std::string_view rest = line.substr(std::min(line.find(' '), line.size()));
  return rest.starts_with(" warn ") || rest.starts_with(" error ");
}

bool IsNamedIn(std::string_view line) {
  if (line.find(kAttackerRuri) != std::string_view::npos) return true;
  const auto has = [line](const std::string& address) {
    return line.find("=" + address + " ") != std::string_view::npos ||
           line.find("=" + address + ":") != std::string_view::npos;
  };
  const auto many = testing::LoopbackSources(kFirstOfManySources, kManySources);
  return has(std::string(kAttackerSource)) || std::ranges::any_of(many, has);
}

/// `uplinkd_x_total{cause="resets"}`: resets; without a label the name without what all have.
std::string LabelOf(std::string_view sample) {
  const std::size_t quote = sample.find('"');
  if (quote != std::string_view::npos) {
    return std::string(sample.substr(quote + 1, sample.rfind('"') - quote - 1));
  }
  constexpr std::string_view kHead = "uplinkd_";
  constexpr std::string_view kTail = "_total";
  return std::string(sample.substr(kHead.size(), sample.size() - kHead.size() - kTail.size()));
}

}  // namespace

std::string_view LineThatNames(std::string_view log) {
  while (!log.empty()) {
    const std::string_view line = log.substr(0, log.find('\n'));
    if (IsWarning(line) && IsNamedIn(line)) return line;
    log.remove_prefix(std::min(line.size() + 1, log.size()));
  }
  return {};
}

std::string GrownMost(const Samples& before, const Samples& after) {
  std::string_view name;
  double most = 0;
  for (const std::string_view trace : kTraces) {
    for (const auto& [sample, value] : after) {
      if (!sample.starts_with(trace)) continue;
      const auto found = before.find(sample);
      const double grown = value - (found == before.end() ? 0 : found->second);
      if (grown <= most) continue;
      most = grown;
      name = sample;
    }
    // The first that counted anything says what it was.
    if (most > 0) return fmt::format("{} {:.0f}", LabelOf(name), most);
  }
  return "";
}

}  // namespace uplink::bench
