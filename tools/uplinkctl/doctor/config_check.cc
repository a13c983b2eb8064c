#include "tools/uplinkctl/doctor/config_check.h"

#include <string_view>

#include <fmt/core.h>

#include "schema/base/doc_page.h"

namespace uplink::ctl {
namespace {

bool Holds(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

constexpr std::string_view kDenied = "Permission denied";
/// What stands in most texts between what is wrong and what to do.
constexpr std::string_view kBeforeRemedy = "; ";

/// `where` of the problem, unless its text names that already, and the text.
std::string What(const config::Problem& problem) {
  // Whom the file must be readable for, only we know.
  std::string text = Holds(problem.text, kDenied)
                         ? problem.text.substr(0, problem.text.find(kBeforeRemedy))
                         : problem.text;
  if (problem.where.empty() || Holds(text, problem.where)) return text;
  return problem.where + ": " + text;
}

/// What the text does not say itself.
std::string RemedyOf(const config::Problem& problem, const std::string& user) {
  const std::string& text = problem.text;
  if (Holds(text, "did you mean")) {
    return DocPage("docs/operate/configuration.md") + " has all keys";
  }
  if (Holds(text, kDenied)) {
    return fmt::format("let the user {} read it, and enter its folders (chgrp, chmod)", user);
  }
  if (Holds(text, kBeforeRemedy)) return {};
  return "correct it, then run this again";
}

std::string RemedyOf(const config::Note& note) {
  if (Holds(note.text, "chmod")) return {};
  if (note.event == "secret_readable") return "run chmod o-r " + note.where;
  if (note.event == "secret_writable") return "run chmod g-w " + note.where;
  if (note.event == "setting_without_effect") return "remove it";
  if (note.event == "variables_ignored") return {};
  return DocPage("docs/operate/configuration.md") + " says how";
}

}  // namespace

Findings ConfigFindings(const config::LoadResult& result, const std::string& file,
                        const std::string& user) {
  Findings findings;
  for (const config::Problem& problem : result.problems) {
    findings.push_back(Error(problem.key.empty() ? "configuration" : problem.key, What(problem),
                             RemedyOf(problem, user)));
  }
  for (const config::Note& note : result.notes) {
    findings.push_back(
        Warning(note.key.empty() ? "configuration" : note.key, What(note), RemedyOf(note)));
  }
  if (result.problems.empty()) findings.push_back(Ok("configuration", file + " is good"));
  return findings;
}

std::set<std::string> KeysAtFault(const config::LoadResult& result) {
  std::set<std::string> keys;
  for (const config::Problem& problem : result.problems) keys.insert(problem.key);
  return keys;
}

}  // namespace uplink::ctl
