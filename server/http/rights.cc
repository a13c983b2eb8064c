#include "server/http/rights.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "schema/base/utf8.h"

namespace uplink::http {
namespace {

using identity::Role;

/// Bytes of a caller's name that an answer repeats.
constexpr std::size_t kNameBytesMax = identity::kSubjectBytesMax;

constexpr std::array<Role, 4> kOperators{Role::kMetrics, Role::kViewer, Role::kOperator,
                                         Role::kAdmin};

/// `the role viewer, operator or admin`
std::string RolesOf(Right right) {
  std::string text;
  std::size_t left = static_cast<std::size_t>(
      std::ranges::count_if(kOperators, [right](Role role) { return Has(role, right); }));
  for (const Role role : kOperators) {
    if (!Has(role, right)) continue;
    --left;
    text += identity::ToText(role);
    if (left > 0) text += left == 1 ? " or " : ", ";
  }
  return text;
}

/// `1f2e3d4c` of a token, a subject of a certificate.
std::string Shown(const std::string& name) { return PrintableUtf8(name, kNameBytesMax); }

}  // namespace

bool Has(Role role, Right right) {
  switch (role) {
    case Role::kAdmin:
      return true;
    case Role::kOperator:
      return right != Right::kAdminister;
    case Role::kViewer:
      return right == Right::kRead || right == Right::kScrape || right == Right::kAnyone;
    case Role::kMetrics:
      return right == Right::kScrape || right == Right::kAnyone;
    case Role::kRobot:
    case Role::kGateway:
      break;
  }
  return right == Right::kAnyone;
}

Forbidden WhyForbidden(const Route& route, Role role, const std::string& name) {
  return {Denied::kRole,
          fmt::format("this needs the role {}; {} has the role {}", RolesOf(route.needs.right),
                      Shown(name), identity::ToText(role))};
}

std::optional<Forbidden> WhyForbidden(const Route& route, const identity::Caller& caller) {
  if (!Has(caller.role, route.needs.right)) return WhyForbidden(route, caller.role, caller.name);
  if (!route.needs.whole || caller.scope.all()) return std::nullopt;
  return Forbidden{
      Denied::kScope,
      fmt::format("this speaks of the whole server, so it needs the scope *; {} has the role {} "
                  "for {} alone",
                  Shown(caller.name), identity::ToText(caller.role),
                  fmt::join(caller.scope.fleets(), ", "))};
}

}  // namespace uplink::http
