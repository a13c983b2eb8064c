#include "server/config/help_tree.h"

#include <vector>

#include <CLI/CLI.hpp>

namespace uplink::config {
namespace {

std::string Quoted(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '\n') {
      quoted += "\\n";
      continue;
    }
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

std::string Joined(const std::vector<std::string>& items) {
  return "[" + CLI::detail::join(items, ",") + "]";
}

std::string TreeOf(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back(Quoted("-" + name));
  for (const std::string& name : option.get_lnames()) names.push_back(Quoted("--" + name));
  std::vector<std::string> excludes;
  for (const CLI::Option* other : option.get_excludes()) {
    excludes.push_back(Quoted(other->get_name()));
  }
  // A switch takes no value.
  const bool value = option.get_items_expected_max() > 0;
  return "{\"names\":" + Joined(names) +
         ",\"position\":" + Quoted(option.get_positional() ? option.get_name(true) : "") +
         ",\"takes\":" + Quoted(value ? option.get_type_name() : "") +
         ",\"default\":" + Quoted(option.get_default_str()) +
         ",\"required\":" + (option.get_required() ? "true" : "false") +
         ",\"several\":" + (option.get_expected_max() > 1 ? "true" : "false") +
         ",\"excludes\":" + Joined(excludes) + ",\"about\":" + Quoted(option.get_description()) +
         "}";
}

std::string TreeOf(const CLI::App& app) {
  std::vector<std::string> options;
  for (const CLI::Option* option : app.get_options()) options.push_back(TreeOf(*option));
  std::vector<std::string> commands;
  std::vector<std::string> groups;
  for (const CLI::App* part : app.get_subcommands(nullptr)) {
    // The library's groups of flags are commands without a name.
    (part->get_name().empty() ? groups : commands).push_back(TreeOf(*part));
  }
  return "{\"name\":" + Quoted(app.get_name()) + ",\"about\":" + Quoted(app.get_description()) +
         ",\"footer\":" + Quoted(app.get_footer()) + ",\"options\":" + Joined(options) +
         ",\"exactlyOneOf\":" + Joined(groups) + ",\"commands\":" + Joined(commands) + "}";
}

}  // namespace

std::string HelpTree(const CLI::App& program) { return TreeOf(program); }

}  // namespace uplink::config
