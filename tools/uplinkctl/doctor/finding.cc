#include "tools/uplinkctl/doctor/finding.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/core.h>

#include "tools/uplinkctl/show/one_line.h"

namespace uplink::ctl {
namespace {

std::string_view WordOf(Severity severity) {
  switch (severity) {
    case Severity::kOk:
      return "ok";
    case Severity::kWarning:
      return "warning";
    case Severity::kError:
      return "error";
  }
  return {};
}

std::string Counted(std::ptrdiff_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

}  // namespace

Finding Ok(std::string where, std::string what) {
  return {Severity::kOk, std::move(where), std::move(what)};
}

Finding Warning(std::string where, std::string what, std::string remedy) {
  return {Severity::kWarning, std::move(where), std::move(what), std::move(remedy)};
}

Finding Error(std::string where, std::string what, std::string remedy) {
  return {Severity::kError, std::move(where), std::move(what), std::move(remedy)};
}

std::string ToText(const Finding& finding) {
  std::string line =
      fmt::format("{:<8} {}: {}", WordOf(finding.severity), finding.where, finding.what);
  if (!finding.remedy.empty()) line += (line.ends_with('?') ? " " : "; ") + finding.remedy;
  return OneLine(line);
}

void Append(Findings& to, Findings from) {
  to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

int ExitOfFindings(const Findings& findings) {
  Severity worst = Severity::kOk;
  for (const Finding& finding : findings) worst = std::max(worst, finding.severity);
  switch (worst) {
    case Severity::kOk:
      return 0;
    case Severity::kWarning:
      return kExitWarnings;
    case Severity::kError:
      return kExitErrors;
  }
  return kExitErrors;
}

std::string Summary(const Findings& findings) {
  const auto count = [&](Severity severity) {
    return std::count_if(findings.begin(), findings.end(),
                         [severity](const Finding& each) { return each.severity == severity; });
  };
  return fmt::format("{}, {}", Counted(count(Severity::kError), "error"),
                     Counted(count(Severity::kWarning), "warning"));
}

}  // namespace uplink::ctl
