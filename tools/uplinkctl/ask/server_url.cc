#include "tools/uplinkctl/ask/server_url.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "tools/uplinkctl/probe.h"

namespace uplink::ctl {
namespace {

constexpr std::string_view kScheme = "http://";

bool IsPathCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/' ||
         c == '-' || c == '.' || c == '_' || c == '~' || c == '%';
}

}  // namespace

absl::StatusOr<ServerUrl> ParseServerUrl(const std::string& url, const std::string& named) {
  if (url.starts_with("https://")) {
    return absl::InvalidArgumentError(fmt::format(
        "{} \"{}\": uplinkctl speaks http alone; reach a distant server by a tunnel: ssh -N -L "
        "7480:127.0.0.1:7480 HOST",
        named, url));
  }
  if (url.find('@') != std::string::npos) {
    return absl::InvalidArgumentError(
        fmt::format("{}: it must have neither user nor password", named));
  }
  const std::size_t slash =
      url.starts_with(kScheme) ? url.find('/', kScheme.size()) : std::string::npos;
  std::string prefix = slash == std::string::npos ? "" : url.substr(slash);
  while (prefix.ends_with('/')) prefix.pop_back();
  if (!std::ranges::all_of(prefix, IsPathCharacter)) {
    return absl::InvalidArgumentError(
        fmt::format("{} \"{}\": its path has a character that none has", named, url));
  }
  absl::StatusOr<std::string> address = AddressOfUrl(url.substr(0, slash), named);
  if (!address.ok()) return address.status();
  return ServerUrl{*std::move(address), std::move(prefix)};
}

}  // namespace uplink::ctl
