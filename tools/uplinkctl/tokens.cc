#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "schema/base/clock.h"
#include "schema/base/rfc3339.h"
#include "server/identity/fleet_name.h"
#include "server/identity/token_file.h"
#include "tools/uplinkctl/command.h"
#include "tools/uplinkctl/tokens/request.h"
#include "tools/uplinkctl/verbs/common.h"

namespace uplink::ctl {
namespace {

namespace json = boost::json;

struct Request {
  std::string config;
  std::string file;
  TokenRequest token;
  std::string id;
  CommonFlags common;
};
using SharedRequest = std::shared_ptr<Request>;
using TokenWork = absl::Status (*)(const Request& request, const std::string& path);

Columns TokenColumns() {
  return {{"ID", "id"},
          {"ROLE", "role"},
          {"FLEETS", "fleets", Kind::kList, Fit::kShrink},
          {"EXPIRES", "expires", Kind::kAge},
          {"EXPIRED", "expired", Kind::kYes, Fit::kDrop},
          {"CREATED", "created", Kind::kAge},
          {"NOTE", "note", Kind::kText, Fit::kShrink}};
}

std::string FleetsText(const identity::Scope& scope) {
  return scope.all() ? std::string("all fleets")
                     : fmt::format("{}", fmt::join(scope.fleets(), ", "));
}

json::object ObjectOf(const identity::TokenEntry& entry, SystemTime now) {
  json::array fleets;
  if (entry.scope.all()) fleets.emplace_back(std::string(identity::kAllFleets));
  for (const std::string& fleet : entry.scope.fleets()) fleets.emplace_back(fleet);
  return {{"id", entry.id},
          {"role", std::string(identity::ToText(entry.role))},
          {"fleets", std::move(fleets)},
          {"expires", entry.expires ? json::value(Rfc3339(*entry.expires)) : json::value(nullptr)},
          {"expired", entry.expires && *entry.expires <= now},
          {"created", Rfc3339(entry.created)},
          {"note", entry.note}};
}

absl::Status New(const Request& request, const std::string& path) {
  const SystemClock clock;
  auto entry = EntryOf(request.token, clock.System());
  if (!entry.ok()) return entry.status();
  const absl::StatusOr<std::string> token = AddToken(path, *entry);
  if (!token.ok()) return token.status();
  // Alone on standard output, for a shell that keeps it.
  fmt::print("{}\n", *token);
  if (std::fflush(stdout) != 0) {
    return absl::InternalError(
        fmt::format("the token cannot be printed, and it is nowhere else; uplinkctl tokens revoke "
                    "{} removes its line",
                    entry->id));
  }
  ProcessScreen(clock).note(fmt::format(
      "token {}, {} of {}, {}, is in {}; it is shown this once", entry->id, request.token.role,
      FleetsText(entry->scope),
      entry->expires ? "until " + Rfc3339(*entry->expires) : std::string("without an end"), path));
  return absl::OkStatus();
}

absl::Status List(const Request& request, const std::string& path) {
  const auto read = identity::ReadTokenFile(path);
  if (!read.ok()) return read.status();
  const SystemClock clock;
  const Screen screen = ProcessScreen(clock);
  json::array rows;
  for (const identity::TokenEntry& entry : read->table.entries()) {
    rows.push_back(ObjectOf(entry, clock.System()));
  }
  switch (request.common.format()) {
    case Format::kJson:
      screen.print(DocumentText(json::object{{"tokens", std::move(rows)}}, false));
      break;
    case Format::kCsv:
      screen.print(CsvOf(TokenColumns(), rows, true));
      break;
    case Format::kTable:
      if (rows.empty()) screen.note("there is no token in " + path);
      for (json::value& row : rows) {
        if (json::value& expires = row.as_object()["expires"]; expires.is_null()) expires = kNever;
      }
      screen.print(TableOf(TokenColumns(), rows, screen.Terms()));
      break;
  }
  return absl::OkStatus();
}

absl::Status Revoke(const Request& request, const std::string& path) {
  if (absl::Status revoked = RevokeToken(path, request.id); !revoked.ok()) return revoked;
  fmt::print("revoked {}; a server that reads {} refuses it within 5 s\n", request.id, path);
  return absl::OkStatus();
}

int Do(const Request& request, TokenWork work) {
  const auto path = TokensFileOf(request.file, request.config, config::ProcessEnvironment());
  return ExitOf(path.ok() ? work(request, *path) : path.status());
}

config::Flags& AddVerb(config::Flags& noun, const SharedRequest& request, const char* name,
                       const char* about, TokenWork work) {
  config::Flags& verb =
      noun.AddCommand(name, about, [request, work] { return Do(*request, work); });
  verb.Add({"--config", fmt::format("The server's configuration file, whose http.tokens_file it is "
                                    "(without a flag {})",
                                    config::kConfigFileDefault)},
           request->config);
  verb.Add({"--tokens-file", "The file of tokens itself"}, request->file);
  verb.AtMostOne({"--config", "--tokens-file"});
  return verb;
}

void AddNew(config::Flags& noun) {
  const auto request = std::make_shared<Request>();
  config::Flags& verb = AddVerb(
      noun, request, "new", "Make a token, print it this once, and add its hash to the file", New);
  verb.AddChoice({"--role", "What it may do"}, request->token.role,
                 {"viewer", "operator", "admin", "metrics"});
  verb.Add({"--fleet", "Fleet that it may see (repeatable); *: all", config::Flag::Need::kRequired},
           request->token.fleets);
  verb.Add({"--expires", "How long it counts: a duration such as 90d, or never"},
           request->token.expires);
  verb.Add({"--note", "Who has it, and for what; of at most 200 characters"}, request->token.note);
  verb.Example("uplinkctl tokens new --role viewer --fleet north --expires 90d --note 'hall 7'");
  verb.Example("uplinkctl tokens new --role metrics --fleet '*' --expires never > scrape.token");
}

}  // namespace

void AddTokens(config::Flags& program) {
  config::Flags& noun =
      program.AddCommand("tokens", "Tokens by which people and programs ask the server");
  AddNew(noun);
  const auto listed = std::make_shared<Request>();
  config::Flags& list =
      AddVerb(noun, listed, "list", "List the tokens of the file, and when each expires", List);
  AddOutputFlags(list, listed->common, false);
  list.Example("uplinkctl tokens list");
  const auto revoked = std::make_shared<Request>();
  config::Flags& revoke = AddVerb(noun, revoked, "revoke", "Take a token out of the file", Revoke);
  revoke.Add({"ID", "Its id, as tokens list shows it", config::Flag::Need::kRequired}, revoked->id);
  revoke.Example("uplinkctl tokens revoke 1a2b3c4d");
}

}  // namespace uplink::ctl
