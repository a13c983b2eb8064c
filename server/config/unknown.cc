#include "server/config/unknown.h"

#include <vector>

#include <fmt/core.h>

#include "schema/base/doc_page.h"
#include "server/config/nearest.h"
#include "server/config/settings.h"

namespace uplink::config {
namespace {

std::string DeleteLine() {
  return "; delete it, or take one of " + DocPage("docs/operate/configuration.md");
}

/// Sections that have a key of this name.
std::vector<std::string_view> SectionsOf(std::string_view key) {
  std::vector<std::string_view> sections;
  for (const Setting& setting : Settings()) {
    if (setting.key == key) sections.push_back(setting.section);
  }
  return sections;
}

}  // namespace

std::string UnknownKeyText(std::string_view section, std::string_view key) {
  const std::string wrong = fmt::format("{}.{}", section, key);
  std::vector<std::string> names;
  for (const Setting& setting : Settings()) names.push_back(FullKey(setting));
  if (!NearestName(wrong, names)) {
    if (const auto sections = SectionsOf(key); sections.size() == 1) {
      return fmt::format("unknown key; did you mean {}.{}?", sections.front(), key);
    }
  }
  return "unknown key" + DidYouMean(wrong, names, DeleteLine());
}

std::string UnknownSectionText(std::string_view name) {
  std::vector<std::string> names;
  for (const Section& section : Sections()) names.emplace_back(section.name);
  return "unknown section" + DidYouMean(name, names, DeleteLine());
}

std::string KeyOutsideText(std::string_view key) {
  const auto sections = SectionsOf(key);
  return fmt::format("it stands in no section; write it below its section's line, such as [{}]",
                     sections.empty() ? Sections().front().name : sections.front());
}

std::string UnknownVariableText(std::string_view variable) {
  std::vector<std::string> names;
  for (const Setting& setting : Settings()) names.push_back(EnvironmentName(setting));
  return "no key has this variable" +
         DidYouMean(variable, names, "; unset it: variables are UPLINKD_<SECTION>_<KEY>");
}

}  // namespace uplink::config
