#include "tools/uplinkctl/ask/robot_names.h"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "tools/uplinkctl/show/short_names.h"

namespace uplink::ctl {
namespace {

constexpr std::string_view kScheme = "rcan://";
/// Robots among which a name is looked for: as many as a page has.
constexpr std::size_t kFoundMax = kPageRowsMax;

std::string ListText(const std::vector<std::string>& ruris) {
  std::string text;
  for (std::size_t i = 0; i < std::min(ruris.size(), kCandidatesShown); ++i) {
    text += (i == 0 ? "" : ", ") + ruris[i];
  }
  return ruris.size() > kCandidatesShown
             ? fmt::format("{} and {} others", text, ruris.size() - kCandidatesShown)
             : text;
}

/// Those whose last segment, or last two, are the name.
std::vector<std::string> Named(const std::vector<std::string>& found, const std::string& name) {
  std::vector<std::string> named;
  std::ranges::copy_if(found, std::back_inserter(named), [&name](const std::string& ruri) {
    return LastSegments(ruri, 1) == name || LastSegments(ruri, 2) == name;
  });
  return named;
}

std::vector<std::string> RurisOf(const Rows& rows) {
  std::vector<std::string> ruris;
  for (const auto& row : rows.rows) {
    if (row.is_object()) ruris.push_back(TextAt(row.get_object(), "ruri"));
  }
  return ruris;
}

}  // namespace

absl::StatusOr<std::string> ResolveRobot(Api& api, const std::string& name) {
  if (name.starts_with(kScheme)) return name;
  const absl::StatusOr<Rows> rows =
      api.List("/api/v1/robots", "robots", {{"q", name}, {"parts", "none"}}, kFoundMax);
  if (!rows.ok()) return rows.status();
  const std::vector<std::string> found = RurisOf(*rows);
  const std::vector<std::string> named = Named(found, name);
  if (named.size() == 1) return named.front();
  if (named.size() > 1) {
    return absl::InvalidArgumentError(fmt::format("{} robots are called {}: {}; name one of them",
                                                  named.size(), name, ListText(named)));
  }
  return absl::NotFoundError(fmt::format(
      "there is no robot {} now; {}", name,
      found.empty() ? "uplinkctl robots list shows all. Of one that the server has forgotten give "
                      "the whole RURI"
                    : "alike are " + ListText(found)));
}

absl::StatusOr<std::vector<std::string>> ResolveRobots(Api& api,
                                                       const std::vector<std::string>& names) {
  std::vector<std::string> ruris;
  for (const std::string& name : names) {
    absl::StatusOr<std::string> ruri = ResolveRobot(api, name);
    if (!ruri.ok()) return ruri.status();
    ruris.push_back(*std::move(ruri));
  }
  return ruris;
}

std::vector<std::string> RobotsOf(Api& api) {
  const absl::StatusOr<Rows> rows =
      api.List("/api/v1/robots", "robots", {{"parts", "none"}}, kNamedRobotsMax);
  return rows.ok() ? RurisOf(*rows) : std::vector<std::string>();
}

}  // namespace uplink::ctl
