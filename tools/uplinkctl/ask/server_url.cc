#include "tools/uplinkctl/ask/server_url.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "schema/base/utf8.h"
#include "server/config/address.h"

namespace uplink::ctl {
namespace {

constexpr std::string_view kHttp = "http://";
constexpr std::string_view kHttps = "https://";
constexpr std::string_view kUnix = "unix:";
/// Bytes of a URL that an error repeats.
constexpr std::size_t kShownBytesMax = 300;

bool IsPathCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/' ||
         c == '-' || c == '.' || c == '_' || c == '~' || c == '%';
}

bool IsPort(std::string_view text) {
  unsigned port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  return error == std::errc() && end == text.data() + text.size() && port > 0 && port < 65'536;
}

/// What is wrong with HOST or HOST:PORT; empty if nothing is. Adds the port of the scheme.
std::string CompleteAddress(std::string& address, bool tls) {
  if (address.find_first_of("?# ") != std::string::npos) return "it has more than that";
  const std::size_t bracket = address.rfind(']');
  const std::size_t colon = address.find(':', bracket == std::string::npos ? 0 : bracket);
  const std::string_view host = std::string_view(address).substr(0, colon);
  if (host.empty() || host == "[]") return "it has no host";
  if ((host.front() == '[') != (host.back() == ']')) return "its brackets do not match";
  if (colon == std::string::npos) {
    address += tls ? ":443" : ":80";
    return {};
  }
  return IsPort(std::string_view(address).substr(colon + 1)) ? "" : "its port is none";
}

}  // namespace

absl::StatusOr<ServerUrl> ParseServerUrl(const std::string& url, const std::string& named) {
  // Before the text is repeated: it may have a password.
  if (url.find('@') != std::string::npos && !url.starts_with(kUnix)) {
    return absl::InvalidArgumentError(
        fmt::format("{}: it must have neither user nor password", named));
  }
  const auto wrong = [&](std::string_view why) {
    return absl::InvalidArgumentError(
        fmt::format("{} \"{}\": {}; it is {}, an IPv6 host in brackets", named,
                    PrintableUtf8(url, kShownBytesMax), why, kUrlForms));
  };
  if (url.starts_with(kUnix)) {
    const auto socket = config::ParseListenAddress(url);
    if (!socket) return wrong("it names no socket");
    return ServerUrl{.address = socket->path};
  }
  const bool tls = url.starts_with(kHttps);
  if (!tls && !url.starts_with(kHttp)) return wrong("it begins with none of these");
  const std::size_t begin = tls ? kHttps.size() : kHttp.size();
  const std::size_t slash = url.find('/', begin);
  ServerUrl parsed{.address = url.substr(begin, slash - begin), .tls = tls};
  if (slash != std::string::npos) parsed.prefix = url.substr(slash);
  while (parsed.prefix.ends_with('/')) parsed.prefix.pop_back();
  if (!std::ranges::all_of(parsed.prefix, IsPathCharacter)) {
    return wrong("its path has a character that none has");
  }
  if (const std::string why = CompleteAddress(parsed.address, tls); !why.empty()) return wrong(why);
  return parsed;
}

std::string ToText(const ServerUrl& url) {
  if (url.address.starts_with('/')) return std::string(kUnix) + url.address;
  return fmt::format("{}{}{}", url.tls ? kHttps : kHttp, url.address, url.prefix);
}

}  // namespace uplink::ctl
