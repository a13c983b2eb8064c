#include "server/config/reference.h"

#include <algorithm>

#include <fmt/core.h>

#include "server/config/settings.h"

namespace uplink::config {
namespace {

constexpr std::size_t kColumns = 96;

/// `text` as comment lines that break at blanks.
std::string Comment(std::string_view text) {
  std::string lines;
  while (!text.empty()) {
    std::size_t end = text.size();
    if (end > kColumns) {
      end = text.rfind(' ', kColumns);
      end = end == std::string_view::npos ? text.size() : end;
    }
    lines += fmt::format("# {}\n", text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::string Escaped(std::string_view cell) {
  std::string escaped;
  for (const char c : cell) {
    escaped += c == '|' ? std::string("\\|") : std::string(1, c);
  }
  return escaped;
}

/// What a key's text does not say of when it counts; empty if it is read once, at the start.
std::string_view EffectText(const Setting& setting) {
  return setting.effect == Effect::kReload ? "Taken over by SIGHUP." : "";
}

/// The reference leaves out a key that does nothing yet.
bool IsShown(const Setting& setting) { return setting.effect != Effect::kNone; }

}  // namespace

std::string ExampleToml() {
  const Config defaults;
  std::string text = Comment(
      "Configuration of uplinkd. Every key that has an effect stands here, commented, with its "
      "default. Durations "
      "and sizes are strings with their unit (\"500ms\" \"10s\" \"2m\" \"1h\" \"1d\"; \"512B\" "
      "\"64KiB\" \"1MiB\" \"1GiB\"); an unknown key is an error. UPLINKD_<SECTION>_<KEY> in the "
      "environment overrides a key. `uplinkd --config FILE --check-config` reports every problem "
      "at once.");
  for (const Section& section : Sections()) {
    text += fmt::format("\n{}[{}]\n", Comment(section.text), section.name);
    for (const Setting& setting : Settings()) {
      if (setting.section != section.name || !IsShown(setting)) {
        continue;
      }
      text +=
          fmt::format("\n{}{}{}# {} = {}\n", Comment(setting.text), Comment(EffectText(setting)),
                      Comment(fmt::format("Takes {}.", AllowedText(setting))), setting.key,
                      ValueText(setting, setting.get(defaults)));
    }
  }
  return text;
}

std::string SettingsTable() {
  const Config defaults;
  std::string text = "| key | default | takes | what it does |\n| --- | --- | --- | --- |\n";
  for (const Setting& setting : Settings()) {
    if (!IsShown(setting)) continue;
    const std::string_view effect = EffectText(setting);
    text += fmt::format("| `{}` | `{}` | {} | {}{}{} |\n", FullKey(setting),
                        ValueText(setting, setting.get(defaults)), Escaped(AllowedText(setting)),
                        Escaped(setting.text), effect.empty() ? "" : " ", effect);
  }
  return text;
}

}  // namespace uplink::config
