#include "tools/uplinkctl/ask/contexts.h"

#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include <fmt/core.h>
#include <unistd.h>

#include "schema/base/clock.h"
#include "tools/uplinkctl/ask/server_url.h"
#include "tools/uplinkctl/command.h"
#include "tools/uplinkctl/verbs/common.h"

namespace uplink::ctl {
namespace {

struct Request {
  std::string name;
  std::string server;
  bool use = false;
  CommonFlags common;
};
using SharedRequest = std::shared_ptr<Request>;

const Columns& ContextColumns() {
  static const Columns columns = {
      {"CURRENT", "current", Kind::kYes}, {"NAME", "name"}, {"SERVER", "server"}};
  return columns;
}

absl::Status List(const Request& request) {
  const std::string path = ContextsFile(environ);
  const absl::StatusOr<Contexts> contexts = LoadContexts(path);
  if (!contexts.ok()) return contexts.status();
  boost::json::array rows;
  for (const auto& [name, context] : contexts->by_name) {
    rows.push_back(boost::json::object{
        {"current", name == contexts->current}, {"name", name}, {"server", context.server}});
  }
  const SystemClock clock;
  const Screen screen = ProcessScreen(clock);
  switch (request.common.format()) {
    case Format::kJson:
      screen.print(DocumentText(boost::json::object{{"contexts", std::move(rows)}}, false));
      break;
    case Format::kCsv:
      screen.print(CsvOf(ContextColumns(), rows, true));
      break;
    case Format::kTable:
      if (rows.empty())
        screen.note("there is no context; add one by uplinkctl contexts add NAME --server URL");
      screen.print(TableOf(ContextColumns(), rows, screen.Terms()));
      break;
  }
  return absl::OkStatus();
}

absl::Status Use(const Request& request) {
  const std::string path = ContextsFile(environ);
  absl::StatusOr<Contexts> contexts = LoadContexts(path);
  if (!contexts.ok()) return contexts.status();
  const auto found = contexts->by_name.find(request.name);
  if (found == contexts->by_name.end()) {
    return absl::InvalidArgumentError(
        fmt::format("there is no context {}; uplinkctl contexts list shows those that are there",
                    request.name));
  }
  contexts->current = request.name;
  if (absl::Status saved = SaveContexts(*contexts, path); !saved.ok()) return saved;
  fmt::print("uplinkctl asks {} now: {}\n", request.name, found->second.server);
  return absl::OkStatus();
}

absl::Status AddOne(const Request& request) {
  if (absl::Status good = CheckContextName(request.name); !good.ok()) return good;
  const absl::StatusOr<ServerUrl> url = ParseServerUrl(request.server, "--server");
  if (!url.ok()) return url.status();
  const std::string path = ContextsFile(environ);
  absl::StatusOr<Contexts> contexts = LoadContexts(path);
  if (!contexts.ok()) return contexts.status();
  contexts->by_name.insert_or_assign(request.name, Context{request.server});
  if (request.use || contexts->by_name.size() == 1) contexts->current = request.name;
  if (absl::Status saved = SaveContexts(*contexts, path); !saved.ok()) return saved;
  fmt::print("{} is in {}\n", request.name, path);
  return absl::OkStatus();
}

config::Flags& AddVerb(config::Flags& noun, const SharedRequest& request, const char* name,
                       const char* about, absl::Status (*work)(const Request&)) {
  return noun.AddCommand(name, about, [request, work] { return ExitOf(work(*request)); });
}

}  // namespace

void AddContexts(config::Flags& program) {
  config::Flags& noun = program.AddCommand(
      "contexts", "Names for servers, in ~/.config/uplinkctl/config.toml, without secrets");
  const auto request = std::make_shared<Request>();
  config::Flags& list = AddVerb(noun, request, "list", "List the servers that have a name", List);
  AddOutputFlags(list, request->common, false);
  list.Example("uplinkctl contexts list");
  config::Flags& use =
      AddVerb(noun, request, "use", "Ask this server from now on, where no flag names one", Use);
  use.Add({"NAME", "The name that it has", config::Flag::Need::kRequired}, request->name);
  use.Example("uplinkctl contexts use hall");
  config::Flags& add =
      AddVerb(noun, request, "add", "Give a server a name; the first one is used at once", AddOne);
  add.Add({"NAME", "Letters, digits, - and _", config::Flag::Need::kRequired}, request->name);
  add.Add({"--server", "http://HOST:PORT, perhaps with a path", config::Flag::Need::kRequired},
          request->server);
  add.AddSwitch({"--use", "Ask it from now on"}, request->use);
  add.Example("uplinkctl contexts add hall --server http://192.0.2.7:7480 --use");
}

}  // namespace uplink::ctl
