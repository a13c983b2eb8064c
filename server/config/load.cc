#include "server/config/load.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <utility>
#include <variant>

#include <fmt/core.h>
#include <toml++/toml.h>

#include "schema/base/file_text.h"
#include "schema/base/utf8.h"
#include "server/config/broker_relations.h"
#include "server/config/effective.h"
#include "server/config/file_modes.h"
#include "server/config/relations.h"
#include "server/config/removed.h"
#include "server/config/service_variables.h"
#include "server/config/settings.h"
#include "server/config/store_tls.h"
#include "server/config/unknown.h"
#include "server/config/value.h"

namespace uplink::config {
namespace {

/// Longest part of a key that a problem repeats.
constexpr std::size_t kShownBytesMax = 200;

/// Fills one Config from several sources and remembers where each key was set.
/// Confined to one call of ParseConfig.
class Loader {
 public:
  explicit Loader(std::string file) : file_(std::move(file)) {}

  void ReadTable(const toml::table& root) {
    for (const auto& [name, node] : root) {
      ReadSection(std::string(name.str()), node);
    }
    // toml++ keeps keys sorted by name; people read a file from its top.
    const auto by_line = [](const Located& a, const Located& b) { return a.line < b.line; };
    std::stable_sort(located_.begin(), located_.end(), by_line);
    for (Located& located : located_) {
      problems_.push_back(std::move(located.problem));
    }
    located_.clear();
  }

  void ReadEnvironment(const Environment& environment) {
    for (const auto& [name, text] : environment) {
      const Setting* const setting = FindByEnvironment(name);
      if (setting == nullptr && IsServiceVariable(name, text)) {
        ignored_.push_back(Shown(name));
        continue;
      }
      if (setting == nullptr) {
        const Removed* const removed = FindRemovedByEnvironment(name);
        problems_.push_back({std::string(kEnvironment), Shown(name),
                             removed == nullptr
                                 ? UnknownVariableText(name)
                                 : fmt::format("{}: unset this variable", removed->text)});
        continue;
      }
      Take(*setting, InterpretText(*setting, text), std::string(kEnvironment), problems_);
    }
  }

  LoadResult Finish() {
    // The schema of a server is its owner's to migrate.
    if (IsPostgres(config_.store) && !where_.contains("store.migrate")) {
      config_.store.migrate = false;
    }
    if (!where_.contains("cyberwave.robots_max")) {
      config_.cyberwave.robots_max =
          std::min(config_.cyberwave.robots_max, config_.limits.robots_max);
    }
    for (Breach& breach : CheckRelations(config_)) {
      const std::string key = fmt::format("{}.{}", breach.section, breach.key);
      // A key that already has a problem keeps its default here; a second line would mislead.
      if (bad_.count(key) == 0) {
        problems_.push_back({Where(key), key, std::move(breach.text)});
      }
    }
    LoadResult result;
    for (const auto& [key, where] : without_effect_) {
      result.notes.push_back({{where, key, "it is checked but has no effect in this version"},
                              "setting_without_effect"});
    }
    if (auto text = UnverifiedStoreText(config_.store)) {
      result.notes.push_back(
          {{Where("store.url"), "store.url", *std::move(text)}, "store_unverified"});
    }
    if (auto text = UnverifiedBrokerText(config_.mqtt)) {
      result.notes.push_back(
          {{Where("mqtt.url"), "mqtt.url", *std::move(text)}, "broker_unverified"});
    }
    if (!ignored_.empty()) {
      result.notes.push_back(
          {{std::string(kEnvironment), {}, IgnoredText(ignored_)}, "variables_ignored"});
    }
    result.readable = config_;
    if (problems_.empty()) {
      result.config = std::move(config_);
    }
    result.problems = std::move(problems_);
    result.places = std::move(where_);
    return result;
  }

  [[nodiscard]] std::string At(std::uint32_t line) const {
    return fmt::format("{}:{}", file_, line);
  }

 private:
  struct Located {
    std::uint32_t line = 0;
    Problem problem;
  };

  static std::string Shown(std::string_view key) { return PrintableUtf8(key, kShownBytesMax); }

  static const Setting* FindByEnvironment(std::string_view name) {
    for (const Setting& setting : Settings()) {
      if (EnvironmentName(setting) == name) {
        return &setting;
      }
    }
    return nullptr;
  }

  /// A key of keys: `retention` of `retention.history`.
  static bool IsGroup(const std::string& section, const std::string& key) {
    return std::ranges::any_of(Settings(), [&](const Setting& setting) {
      return setting.section == section && setting.key.starts_with(key + ".");
    });
  }

  void ReadSection(const std::string& section, const toml::node& node) {
    const std::uint32_t line = node.source().begin.line;
    const auto known = [&](const Section& each) { return each.name == section; };
    const toml::table* const table = node.as_table();
    if (std::none_of(Sections().begin(), Sections().end(), known)) {
      std::string text = table == nullptr ? KeyOutsideText(section) : UnknownSectionText(section);
      located_.push_back({line, {At(line), Shown(section), std::move(text)}});
      return;
    }
    if (table == nullptr) {
      located_.push_back({line, {At(line), section, fmt::format("write [{}], a table", section)}});
      return;
    }
    for (const auto& [key, value] : *table) {
      ReadKey(section, std::string(key.str()), value, key.source().begin.line);
    }
  }

  void ReadKey(const std::string& section, const std::string& key, const toml::node& node,
               std::uint32_t line) {
    if (const toml::table* const inner = node.as_table();
        inner != nullptr && IsGroup(section, key)) {
      for (const auto& [name, value] : *inner) {
        ReadKey(section, key + "." + std::string(name.str()), value, name.source().begin.line);
      }
      return;
    }
    const Setting* const setting = FindSetting(section, key);
    if (setting == nullptr) {
      const Removed* const removed = FindRemoved(section, key);
      located_.push_back(
          {line,
           {At(line), fmt::format("{}.{}", section, Shown(key)),
            removed == nullptr ? UnknownKeyText(section, key)
                               : fmt::format("{}: delete this line", removed->text)}});
      return;
    }
    std::vector<Problem> found;
    Take(*setting, InterpretNode(*setting, node), At(line), found);
    for (Problem& problem : found) {
      located_.push_back({line, std::move(problem)});
    }
  }

  static Interpreted InterpretNode(const Setting& setting, const toml::node& node) {
    if (setting.kind == Kind::kSwitch && node.is_boolean()) {
      return Value(node.value_or(false));
    }
    if (setting.kind == Kind::kCount && node.is_integer()) {
      return InterpretInteger(setting, node.value_or(std::int64_t{0}));
    }
    const bool list = setting.kind == Kind::kList || setting.kind == Kind::kNetworks;
    if (list && node.is_array()) {
      return InterpretArray(setting, *node.as_array());
    }
    if (setting.kind != Kind::kSwitch && setting.kind != Kind::kCount && !list &&
        node.is_string()) {
      return InterpretText(setting, node.value_or(std::string_view()));
    }
    return BadValue{
        fmt::format("{}it must be {}", QuotesText(setting, node), AllowedText(setting))};
  }

  /// A value in quotes that would be one without them: what to write instead.
  static std::string QuotesText(const Setting& setting, const toml::node& node) {
    if (setting.kind != Kind::kSwitch && setting.kind != Kind::kCount) return {};
    const std::string_view text = node.value_or(std::string_view());
    if (!std::holds_alternative<Value>(InterpretText(setting, text))) return {};
    return fmt::format("it stands in quotes: write {} = {}; ", setting.key, text);
  }

  static Interpreted InterpretArray(const Setting& setting, const toml::array& array) {
    std::vector<std::string> items;
    items.reserve(array.size());
    for (const toml::node& node : array) {
      if (!node.is_string()) return BadValue{fmt::format("it must be {}", AllowedText(setting))};
      items.push_back(node.value_or(std::string()));
    }
    return InterpretList(setting, std::move(items));
  }

  void Take(const Setting& setting, const Interpreted& interpreted, std::string where,
            std::vector<Problem>& problems) {
    std::string key = FullKey(setting);
    if (const auto* bad = std::get_if<BadValue>(&interpreted)) {
      problems.push_back({std::move(where), key, bad->text});
      bad_.insert(std::move(key));
      return;
    }
    setting.set(config_, std::get<Value>(interpreted));
    if (setting.effect == Effect::kNone) {
      without_effect_[key] = where;
    }
    where_[std::move(key)] = std::move(where);
  }

  [[nodiscard]] std::string Where(const std::string& key) const {
    const auto at = where_.find(key);
    return at == where_.end() ? file_ : at->second;
  }

  std::string file_;
  Config config_;
  std::vector<Problem> problems_;
  std::vector<Located> located_;
  Places where_;
  std::map<std::string, std::string> without_effect_;
  std::set<std::string> bad_;
  std::vector<std::string> ignored_;
};

}  // namespace

std::string ToText(const Problem& problem) {
  return problem.key.empty() ? fmt::format("{}: {}", problem.where, problem.text)
                             : fmt::format("{}: {}: {}", problem.where, problem.key, problem.text);
}

LoadResult ParseConfig(std::string_view toml, const std::string& name,
                       const Environment& environment) {
  Loader loader(name);
  try {
    loader.ReadTable(toml::parse(toml));
  } catch (const toml::parse_error& error) {
    // Nothing of the file was read, so its required keys are not missing but unread: one problem.
    LoadResult result;
    result.problems.push_back({loader.At(error.source().begin.line),
                               {},
                               fmt::format("not TOML from here on: {}", error.description())});
    return result;
  }
  loader.ReadEnvironment(environment);
  return loader.Finish();
}

LoadResult LoadConfig(const std::string& path, const Environment& environment) {
  const FileText file = ReadFileText(path, kConfigBytesMax);
  if (!file.problem.empty()) {
    LoadResult unread;
    unread.problems.push_back({path, {}, file.problem});
    return unread;
  }
  LoadResult result = ParseConfig(file.text, path, environment);
  if (const absl::Status writers = CheckWriters(path); !writers.ok()) {
    result.problems.push_back({path, {}, std::string(writers.message())});
    result.config.reset();
  }
  return result;
}

}  // namespace uplink::config
