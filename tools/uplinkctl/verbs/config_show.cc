#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "server/config/load.h"
#include "tools/uplinkctl/command.h"
#include "tools/uplinkctl/verbs/records.h"

namespace uplink::ctl {
namespace {

namespace json = boost::json;

/// The file as a server that starts now would read it, secrets masked.
int ShowFile(const std::string& path) {
  const config::LoadResult read = config::LoadConfig(path, config::ProcessEnvironment());
  for (const config::Problem& problem : read.problems) {
    fmt::print(stderr, "{}\n", config::ToText(problem));
  }
  if (!read.readable) return kExitWrongUse;
  fmt::print("{}", config::PrintConfig(*read.readable));
  return read.problems.empty() ? kExitDone : kExitWrongUse;
}

Columns KeyColumns() {
  return {{"KEY", "key"},
          {"VALUE", "value", Kind::kList, Fit::kShrink},
          {"FROM", "source"},
          {"PLACE", "place", Kind::kText, Fit::kDrop},
          {"CHANGES BY", "effect", Kind::kText, Fit::kDrop}};
}

/// The keys of all sections as rows, each with its section in its name.
json::array RowsOf(const json::object& settings) {
  json::array rows;
  const json::value* sections = MemberAt(settings, "sections");
  if (sections == nullptr || !sections->is_array()) return rows;
  for (const json::value& section : sections->get_array()) {
    const auto* object = section.if_object();
    const json::value* keys = object == nullptr ? nullptr : MemberAt(*object, "keys");
    if (keys == nullptr || !keys->is_array()) continue;
    const std::string before = TextAt(*object, "name") + ".";
    for (const json::value& key : keys->get_array()) {
      if (!key.is_object()) continue;
      json::object row = key.get_object();
      row["key"] = before + TextAt(row, "key");
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

std::string Text(const json::object& settings, Format format, const Screen& screen) {
  switch (format) {
    case Format::kJson:
      return DocumentText(settings, false);
    case Format::kCsv:
      return CsvOf(KeyColumns(), RowsOf(settings), true);
    case Format::kTable:
      return TableOf(KeyColumns(), RowsOf(settings), screen.Terms());
  }
  return {};
}

}  // namespace

void AddConfigShow(config::Flags& noun) {
  const auto flags = std::make_shared<CommonFlags>();
  const auto work = [flags](Api& api, const Screen& screen) -> absl::Status {
    const auto settings = api.Get("/api/v1/config");
    if (!settings.ok()) return settings.status();
    screen.print(Text(*settings, flags->format(), screen));
    return absl::OkStatus();
  };
  config::Flags& verb = noun.AddCommand(
      "show", "Show the settings in effect at a running server, or those of a file; secrets masked",
      [flags, work] {
        return flags->server.config.empty() ? WithServer(flags->server, work)
                                            : ShowFile(flags->server.config);
      });
  AddOutputFlags(verb, *flags, false);
  AddServerFlags(verb, flags->server,
                 "Read this configuration file instead, with this environment's variables over it");
  verb.Example("uplinkctl config show --server http://192.0.2.7:7480");
  verb.Example("uplinkctl config show --config /etc/uplinkd/uplinkd.toml");
}

}  // namespace uplink::ctl
