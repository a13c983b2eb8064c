#include "server/config/tls_groups.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "schema/base/utf8.h"

namespace uplink::config {
namespace {

constexpr std::array<std::string_view, 4> kGroups = {"X25519", "P-256", "P-384", "P-521"};
/// Those of client certificates that `tls.groups` may lack.
constexpr std::array<std::string_view, 3> kGroupsOfCertificates = {"P-256", "P-384", "P-521"};
/// Longest part of a wrong word that a problem repeats.
constexpr std::size_t kShownBytesMax = 100;

bool Has(const auto& list, std::string_view word) {
  return std::ranges::find(list, word) != list.end();
}

}  // namespace

std::optional<std::string> FlawOfGroups(const std::vector<std::string>& groups) {
  const auto allowed = [] { return fmt::format("{}", fmt::join(kGroups, ", ")); };
  if (groups.empty()) return fmt::format("it is empty; it must have at least one of {}", allowed());
  for (const std::string& group : groups) {
    if (Has(kGroups, group)) continue;
    return fmt::format("\"{}\" is no group; take one of {}", PrintableUtf8(group, kShownBytesMax),
                       allowed());
  }
  return std::nullopt;
}

std::string ServedGroups(const TlsConfig& tls) {
  std::vector<std::string> groups = tls.groups;
  if (tls.min_version == TlsVersion::k12) {
    for (const std::string_view group : kGroupsOfCertificates) {
      if (!Has(groups, group)) groups.emplace_back(group);
    }
  }
  return fmt::format("{}", fmt::join(groups, ":"));
}

}  // namespace uplink::config
