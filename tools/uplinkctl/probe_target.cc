#include "tools/uplinkctl/probe_target.h"

#include <algorithm>
#include <cerrno>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/core.h>
#include <unistd.h>

#include "tools/uplinkctl/listeners.h"

namespace uplink::ctl {
namespace {

constexpr std::string_view kVariable = "UPLINKD_LISTEN_HTTP";

/// `source` unless a variable sets the address.
absl::StatusOr<ProbeTarget> TargetOf(const config::LoadResult& read, const std::string& source,
                                     const config::Environment& environment) {
  if (!read.readable) {
    return absl::InvalidArgumentError(
        read.problems.empty() ? source + " cannot be read" : config::ToText(read.problems.front()));
  }
  const bool is_set = std::any_of(environment.begin(), environment.end(),
                                  [](const auto& each) { return each.first == kVariable; });
  const std::string from = is_set ? fmt::format("that of the variable {}", kVariable) : source;
  const config::Config& config = *read.readable;
  if (config.listen.http.port == 0 && !config::IsUnix(config.listen.http)) {
    return absl::InvalidArgumentError(fmt::format(
        "the address is {}, whose port is 0: the server takes any free one; name it by --url",
        from));
  }
  return ProbeTarget{OwnUrl(config), from, config.http.tls_certificate_file};
}

}  // namespace

absl::StatusOr<ProbeTarget> TargetOfUrl(const std::string& url) {
  absl::StatusOr<ServerUrl> parsed = ParseServerUrl(url, "--url");
  if (!parsed.ok()) return parsed.status();
  return ProbeTarget{*std::move(parsed), "that of --url"};
}

absl::StatusOr<ProbeTarget> TargetOfConfig(const std::string& path,
                                           const config::Environment& environment) {
  return TargetOf(config::LoadConfig(path, environment), "listen.http of " + path, environment);
}

absl::StatusOr<ProbeTarget> TargetWithoutFlags(const std::string& usual,
                                               const config::Environment& environment) {
  if (::access(usual.c_str(), R_OK) == 0) return TargetOfConfig(usual, environment);
  const std::string source = fmt::format("the default of listen.http, as {} cannot be read: {}",
                                         usual, std::generic_category().message(errno));
  return TargetOf(config::ParseConfig("", "defaults", environment), source, environment);
}

absl::Status WithSource(const absl::Status& status, const ProbeTarget& target) {
  return {status.code(),
          fmt::format("{}; the address is {}", std::string(status.message()), target.source)};
}

}  // namespace uplink::ctl
