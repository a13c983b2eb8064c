#include "tools/uplinkctl/verbs/list_verb.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "schema/base/rfc3339.h"
#include "server/config/units.h"
#include "tools/uplinkctl/ask/robot_names.h"
#include "tools/uplinkctl/show/ages.h"
#include "tools/uplinkctl/verbs/follow.h"
#include "tools/uplinkctl/verbs/list_text.h"

namespace uplink::ctl {
namespace {

absl::Status WrongTime(std::string_view flag, const std::string& text) {
  return absl::InvalidArgumentError(
      fmt::format("{} {}: it is no time; write {}", flag, text, kMomentForm));
}

/// Adds a time, if there is one.
absl::Status AddTime(Query& query, std::string_view flag, std::string_view parameter,
                     const std::string& text, SystemTime now) {
  if (text.empty()) return absl::OkStatus();
  const auto time = ParseMoment(text, now);
  if (!time) return WrongTime(flag, text);
  query.emplace_back(parameter, Rfc3339(*time));
  return absl::OkStatus();
}

absl::Status AddFilter(Query& query, const Filter& filter, const FilterValue& value,
                       SystemTime now) {
  switch (filter.kind) {
    case Filter::Kind::kText:
      if (!value.text.empty()) query.emplace_back(filter.parameter, value.text);
      return absl::OkStatus();
    case Filter::Kind::kSwitch:
      if (value.on) query.emplace_back(filter.parameter, "true");
      return absl::OkStatus();
    case Filter::Kind::kUnless:
      if (!value.on) query.emplace_back(filter.parameter, "true");
      return absl::OkStatus();
    case Filter::Kind::kBefore:
      return AddTime(query, filter.flag, filter.parameter, value.text, now);
    case Filter::Kind::kWithin: {
      if (value.text.empty()) return absl::OkStatus();
      const auto length = config::ParseDuration(value.text);
      if (!length) {
        return absl::InvalidArgumentError(fmt::format(
            "{} {}: it is no length of time; write 14d, 12h or 30m", filter.flag, value.text));
      }
      query.emplace_back(filter.parameter, Rfc3339(now + *length));
      return absl::OkStatus();
    }
  }
  return absl::OkStatus();
}

void AddFilterFlag(config::Flags& verb, const Filter& filter, FilterValue& value) {
  const config::Flag flag{std::string(filter.flag), std::string(filter.about)};
  if (filter.kind == Filter::Kind::kSwitch || filter.kind == Filter::Kind::kUnless) {
    verb.AddSwitch(flag, value.on);
  } else if (filter.choices.empty()) {
    verb.Add(flag, value.text, NotEmpty());
  } else {
    verb.AddChoice(flag, value.text, filter.choices);
  }
}

void AddTimes(config::Flags& verb, ListFlags& flags) {
  verb.Add({"--since", fmt::format("Only rows from then on, by their first time: {}", kMomentForm)},
           flags.since, NotEmpty());
  verb.Add({"--until", "Only rows until then, by their first time"}, flags.until, NotEmpty());
  verb.AddSwitch({"--oldest", "The oldest first, instead of the newest"}, flags.oldest);
  verb.AtMostOne({"--until", "--follow"});
}

int Run(const List& list, const ListFlags& flags) {
  return WithServer(flags.common.server, [&](Api& api, const Screen& screen) {
    return ShowList(list, flags, api, screen);
  });
}

}  // namespace

void AddList(config::Flags& noun, const List& list) {
  const auto flags = std::make_shared<ListFlags>();
  flags->limit = list.limit;
  config::Flags& verb = noun.AddCommand(std::string(list.verb), std::string(list.about),
                                        [list, flags] { return Run(list, *flags); });
  if (list.of_one_robot) {
    verb.Add({"ROBOT", "The robot: its RURI, or the end of it", config::Flag::Need::kRequired},
             flags->robot);
  }
  if (list.of_fleet) verb.Add({"--fleet", "Only this fleet's"}, flags->fleet, NotEmpty());
  if (list.of_robots) {
    verb.Add({"--robot", "Only this robot's: its RURI, or the end of it (repeatable)"},
             flags->robots);
  }
  for (const Filter& filter : list.filters) {
    AddFilterFlag(verb, filter, flags->filters.emplace_back());
  }
  verb.Add({"--limit", "Rows at most"}, flags->limit, {1, static_cast<double>(list.limit_max)});
  AddOutputFlags(verb, flags->common, true);
  if (list.in_time) AddTimes(verb, *flags);
  AddServerFlags(verb, flags->common.server, list.of_store ? kConfigOfStore : kConfigOfServer);
  for (const std::string_view example : list.examples) verb.Example(std::string(example));
}

absl::StatusOr<Query> QueryOf(const List& list, const ListFlags& flags,
                              const std::vector<std::string>& ruris, SystemTime now) {
  Query query = list.fixed;
  if (!flags.fleet.empty()) query.emplace_back("fleet", flags.fleet);
  for (const std::string& ruri : ruris) query.emplace_back("ruri", ruri);
  for (std::size_t i = 0; i < list.filters.size(); ++i) {
    absl::Status added = AddFilter(query, list.filters[i], flags.filters[i], now);
    if (!added.ok()) return added;
  }
  if (absl::Status added = AddTime(query, "--since", "from", flags.since, now); !added.ok()) {
    return added;
  }
  if (absl::Status added = AddTime(query, "--until", "to", flags.until, now); !added.ok()) {
    return added;
  }
  if (flags.oldest) query.emplace_back("orderBy", "oldest");
  return query;
}

std::vector<std::string> NamedBeside(const List& list, const CommonFlags& flags, Api& api) {
  const bool names = std::ranges::any_of(
      list.columns, [](const Column& column) { return column.kind == Kind::kRobot; });
  return names && flags.format() == Format::kTable ? RobotsOf(api) : std::vector<std::string>();
}

absl::Status ShowList(const List& list, const ListFlags& flags, Api& api, const Screen& screen) {
  std::vector<std::string> names = flags.robots;
  if (list.of_one_robot) names = {flags.robot};
  const absl::StatusOr<std::vector<std::string>> ruris = ResolveRobots(api, names);
  if (!ruris.ok()) return ruris.status();
  const auto query = [&] { return QueryOf(list, flags, *ruris, screen.clock.System()); };
  const absl::StatusOr<Query> first = query();
  if (!first.ok()) return first.status();
  if (flags.common.follow && Grows(list, *first))
    return FollowRows(list, flags, *first, api, screen);
  // Asked for once, with the first rows.
  std::optional<std::vector<std::string>> robots;
  return ShowAgain(screen, flags.common.follow, [&]() -> absl::StatusOr<std::string> {
    // A time before now moves with the clock.
    const absl::StatusOr<Query> asked = query();
    if (!asked.ok()) return asked.status();
    absl::StatusOr<Rows> rows = api.List(std::string(list.path), std::string(list.member), *asked,
                                         static_cast<std::size_t>(flags.limit));
    if (!rows.ok()) return rows.status();
    if (!flags.common.follow) NoteRows(*rows, screen);
    RowTerms terms = screen.Terms();
    if (!rows->rows.empty() && !robots) robots = NamedBeside(list, flags.common, api);
    if (robots) terms.robots = *robots;
    return ListText(list, flags.common, *std::move(rows), terms);
  });
}

}  // namespace uplink::ctl
