#include <memory>
#include <string>
#include <string_view>
#include <variant>

#include <fmt/core.h>

#include "schema/base/clock.h"
#include "server/config/load.h"
#include "storage/postgres/admin.h"
#include "tools/uplinkctl/command.h"
#include "tools/uplinkctl/store_clock.h"
#include "tools/uplinkctl/store_forget.h"
#include "tools/uplinkctl/store_status.h"
#include "tools/uplinkctl/store_target.h"

namespace uplink::ctl {
namespace {

using storage::postgres::AdminOptions;

struct Arguments {
  std::string config;
  std::string url;
  std::string password_file;
  std::string grant_to;
  bool confirm = false;
  bool yes = false;
  std::string ruri;
  bool end_stream = false;
};

/// The store that is named on the command line, or else by the server's configuration.
absl::StatusOr<AdminOptions> AnyTarget(const Arguments& arguments) {
  AdminOptions options{arguments.url, arguments.password_file};
  if (options.url.empty()) {
    const config::LoadResult read =
        config::LoadConfig(arguments.config, config::ProcessEnvironment());
    if (!read.readable) {
      return absl::InvalidArgumentError(read.problems.empty()
                                            ? arguments.config + " cannot be read"
                                            : config::ToText(read.problems.front()));
    }
    options.url = read.readable->store.url;
    if (options.password_file.empty()) options.password_file = read.readable->store.password_file;
  }
  return options;
}

/// The same of a PostgreSQL database; `of_sqlite` says why the verb has no use for an SQLite file.
absl::StatusOr<AdminOptions> DatabaseTarget(const Arguments& arguments,
                                            std::string_view of_sqlite) {
  absl::StatusOr<AdminOptions> options = AnyTarget(arguments);
  if (!options.ok()) return options;
  const auto target = TargetOf(options->url, options->password_file);
  if (!target.ok()) return target.status();
  if (std::holds_alternative<std::string>(*target)) {
    return absl::InvalidArgumentError(fmt::format("the store is an SQLite file: {}", of_sqlite));
  }
  return options;
}

int Clock(const Arguments& arguments) {
  const absl::StatusOr<AdminOptions> target = AnyTarget(arguments);
  if (!target.ok()) return ExitOf(target.status());
  return StoreClock({target->url, target->password_file, arguments.confirm, arguments.yes});
}

int Forget(const Arguments& arguments) {
  const absl::StatusOr<AdminOptions> target = AnyTarget(arguments);
  if (!target.ok()) return ExitOf(target.status());
  return StoreForget(
      {target->url, target->password_file, arguments.ruri, arguments.end_stream, arguments.yes});
}

int Migrate(const Arguments& arguments) {
  const absl::StatusOr<AdminOptions> target = DatabaseTarget(
      arguments, "the server migrates it when it starts, unless store.migrate is false");
  if (!target.ok()) return ExitOf(target.status());
  const SystemClock clock;
  const auto steps = storage::postgres::MigrateStore(*target, arguments.grant_to, clock);
  if (!steps.ok()) return ExitOf(steps.status());
  for (const std::string& step : *steps) fmt::print("applied {}\n", step);
  if (steps->empty()) fmt::print("nothing to apply\n");
  if (!arguments.grant_to.empty()) fmt::print("granted to {}\n", arguments.grant_to);
  return kExitDone;
}

int Status(const Arguments& arguments) {
  const absl::StatusOr<AdminOptions> target = AnyTarget(arguments);
  return target.ok() ? StoreStatus(*target) : ExitOf(target.status());
}

}  // namespace

void AddStore(config::Flags& program) {
  config::Flags& noun = program.AddCommand(
      "store", "The store: its schema, its robots, and the clock that it trusts");
  const auto arguments = std::make_shared<Arguments>();
  const auto add = [&](const char* name, const char* text, const char* urls,
                       int (*work)(const Arguments&)) -> config::Flags& {
    config::Flags& verb =
        noun.AddCommand(name, text, [arguments, work] { return work(*arguments); });
    verb.Add({"--config", "The server's configuration file"}, arguments->config);
    verb.Add({"--url", urls}, arguments->url);
    verb.ExactlyOne("target", {"--config", "--url"});
    verb.Add({"--password-file", "A file whose first line is the password"},
             arguments->password_file);
    return verb;
  };
  constexpr const char* kDatabase = "postgresql://owner@host:port/database";
  constexpr const char* kAny = "postgresql://owner@host:port/database, or sqlite:///path";
  config::Flags& migrate =
      add("migrate", "Apply the steps that are missing, as the owner", kDatabase, Migrate);
  migrate.Add(
      {"--grant-to", "The role that the server logs in as: it may read and write, and no more"},
      arguments->grant_to);
  migrate.Example("uplinkctl store migrate --url postgresql://owner@db/uplinkd --grant-to uplinkd");
  add("status",
      "Show a store: where it is, its schema, its size; 1 if no server could use it, or a database "
      "lacks steps",
      kAny, Status)
      .Example("uplinkctl store status --config /etc/uplinkd/uplinkd.toml");
  config::Flags& clock =
      add("clock", "Show whether this machine's clock is vouched for; 1 if it is not", kAny, Clock);
  clock.AddSwitch({"--confirm", "Vouch for it: the store's mark becomes this machine's time"},
                  arguments->confirm);
  clock.AddSwitch({"--yes", "Do not ask first"}, arguments->yes);
  clock.Example("uplinkctl store clock --config /etc/uplinkd/uplinkd.toml");
  clock.Example("uplinkctl store clock --config /etc/uplinkd/uplinkd.toml --confirm");
  config::Flags& forget =
      add("forget", "Delete all that the store has of a robot; 1 if the robot stays", kAny, Forget);
  forget.Add({"ruri", "The robot: rcan://...", config::Flag::Need::kRequired}, arguments->ruri);
  forget.AddSwitch({"--end-stream", "End the robot's stream first, and wait for its records"},
                   arguments->end_stream);
  forget.AddSwitch({"--yes", "Do not ask first"}, arguments->yes);
  forget.Example(
      "uplinkctl store forget --config /etc/uplinkd/uplinkd.toml rcan://example.org/a/b/1.0/r1");
}

}  // namespace uplink::ctl
