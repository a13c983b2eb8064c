#include "server/http/known_hosts.h"

#include <algorithm>
#include <utility>

#include <arpa/inet.h>

#include "server/http/header_text.h"

namespace uplink::http {
namespace {

bool IsAddress(int family, const std::string& text) {
  in6_addr place{};  // room for either family
  return inet_pton(family, text.c_str(), &place) == 1;
}

/// `:7480`, or nothing.
bool IsPort(std::string_view text) {
  return text.empty() || (text.front() == ':' && std::ranges::all_of(text.substr(1), [](char c) {
                            return c >= '0' && c <= '9';
                          }));
}

/// A host without its port, in lower case; an address of IPv6 keeps its brackets. Empty if what
/// follows it is no port.
std::string NameOf(std::string_view host) {
  const std::size_t bracket = host.starts_with('[') ? host.find(']') : 0;
  if (bracket == std::string_view::npos) return {};
  const std::size_t end = std::min(host.find(':', bracket), host.size());
  return IsPort(host.substr(end)) ? LowerCase(host.substr(0, end)) : std::string();
}

}  // namespace

KnownHosts::KnownHosts(std::vector<std::string> names)
    : names_([&names] {
        for (std::string& name : names) name = LowerCase(name);
        return std::move(names);
      }()) {}

bool KnownHosts::HasName(const std::string& name) const {
  return name == "localhost" || std::ranges::count(names_, name) > 0;
}

bool KnownHosts::HasOrigin(std::string_view origin, std::string_view host) const {
  const std::size_t scheme = origin.find("://");
  if (scheme == std::string_view::npos) return false;
  const std::string name = NameOf(origin.substr(scheme + 3));
  return !name.empty() && (name == NameOf(host) || HasName(name));
}

bool KnownHosts::IsSameOrigin(std::string_view origin, std::string_view host) {
  const std::size_t scheme = origin.find("://");
  return scheme != std::string_view::npos && !host.empty() &&
         SameWord(origin.substr(scheme + 3), host);
}

bool KnownHosts::Has(std::string_view host) const {
  if (host.starts_with('[')) {
    const std::size_t end = host.find(']');
    return end != std::string_view::npos && IsPort(host.substr(end + 1)) &&
           IsAddress(AF_INET6, std::string(host.substr(1, end - 1)));
  }
  const std::size_t colon = std::min(host.find(':'), host.size());
  if (!IsPort(host.substr(colon))) return false;
  const std::string name = LowerCase(host.substr(0, colon));
  return IsAddress(AF_INET, name) || HasName(name);
}

}  // namespace uplink::http
