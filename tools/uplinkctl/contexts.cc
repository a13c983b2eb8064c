#include "tools/uplinkctl/ask/contexts.h"

#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include <fmt/core.h>
#include <unistd.h>

#include "schema/base/clock.h"
#include "tools/uplinkctl/command.h"
#include "tools/uplinkctl/verbs/common.h"

namespace uplink::ctl {
namespace {

struct Request {
  std::string name;
  Context context;
  bool use = false;
  CommonFlags common;
  /// Whether a flag of the verb was given: `set` keeps what is not.
  std::function<bool(const std::string& flag)> given;
};
using SharedRequest = std::shared_ptr<Request>;

const Columns& ContextColumns() {
  static const Columns columns = {{"CURRENT", "current", Kind::kYes},
                                  {"NAME", "name"},
                                  {"SERVER", "server"},
                                  {"TOKEN FILE", "tokenFile", Kind::kText, Fit::kDrop},
                                  {"CERTIFICATE FILE", "certificateFile", Kind::kText, Fit::kDrop},
                                  {"KEY FILE", "keyFile", Kind::kText, Fit::kDrop},
                                  {"CA FILE", "caFile", Kind::kText, Fit::kDrop}};
  return columns;
}

absl::Status List(const Request& request) {
  const std::string path = ContextsFile(environ);
  const absl::StatusOr<Contexts> contexts = LoadContexts(path);
  if (!contexts.ok()) return contexts.status();
  boost::json::array rows;
  for (const auto& [name, context] : contexts->by_name) {
    rows.push_back(boost::json::object{{"current", name == contexts->current},
                                       {"name", name},
                                       {"server", context.server},
                                       {"tokenFile", context.files.token_file},
                                       {"certificateFile", context.files.certificate_file},
                                       {"keyFile", context.files.key_file},
                                       {"caFile", context.files.ca_file}});
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

absl::Status Unknown(const std::string& name) {
  return absl::InvalidArgumentError(fmt::format(
      "there is no context {}; uplinkctl contexts list shows those that are there", name));
}

absl::Status Use(const Request& request) {
  const std::string path = ContextsFile(environ);
  absl::StatusOr<Contexts> contexts = LoadContexts(path);
  if (!contexts.ok()) return contexts.status();
  const auto found = contexts->by_name.find(request.name);
  if (found == contexts->by_name.end()) return Unknown(request.name);
  contexts->current = request.name;
  if (absl::Status saved = SaveContexts(*contexts, path); !saved.ok()) return saved;
  fmt::print("uplinkctl asks {} now: {}\n", request.name, found->second.server);
  return absl::OkStatus();
}

/// Puts the request's context into the file.
absl::Status Save(const Request& request, const Context& context, Contexts contexts,
                  const std::string& path) {
  absl::StatusOr<Context> good = GoodContext(context, "--server");
  if (!good.ok()) return good.status();
  contexts.by_name.insert_or_assign(request.name, *std::move(good));
  if (request.use || contexts.by_name.size() == 1) contexts.current = request.name;
  if (absl::Status saved = SaveContexts(contexts, path); !saved.ok()) return saved;
  fmt::print("{} is in {}\n", request.name, path);
  return absl::OkStatus();
}

absl::Status AddOne(const Request& request) {
  if (absl::Status good = CheckContextName(request.name); !good.ok()) return good;
  const std::string path = ContextsFile(environ);
  absl::StatusOr<Contexts> contexts = LoadContexts(path);
  if (!contexts.ok()) return contexts.status();
  return Save(request, request.context, *std::move(contexts), path);
}

absl::Status Set(const Request& request) {
  const std::string path = ContextsFile(environ);
  absl::StatusOr<Contexts> contexts = LoadContexts(path);
  if (!contexts.ok()) return contexts.status();
  const auto found = contexts->by_name.find(request.name);
  if (found == contexts->by_name.end()) return Unknown(request.name);
  Context context = found->second;
  const auto take = [&](const char* flag, std::string& into, const std::string& value) {
    if (request.given(flag)) into = value;
  };
  const AccessFiles& files = request.context.files;
  take("--server", context.server, request.context.server);
  take("--token-file", context.files.token_file, files.token_file);
  take("--ca-file", context.files.ca_file, files.ca_file);
  take("--certificate-file", context.files.certificate_file, files.certificate_file);
  take("--key-file", context.files.key_file, files.key_file);
  return Save(request, context, *std::move(contexts), path);
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
  add.Add({"--server", fmt::format("{}, http and https perhaps with a path", kUrlForms),
           config::Flag::Need::kRequired},
          request->context.server);
  AddAccessFlags(add, request->context.files);
  add.AddSwitch({"--use", "Ask it from now on"}, request->use);
  add.Example("uplinkctl contexts add hall --server http://192.0.2.7:7480 --use");
  config::Flags& set = AddVerb(noun, request, "set",
                               "Change a server that has a name; an empty file takes it away", Set);
  set.Add({"NAME", "The name that it has", config::Flag::Need::kRequired}, request->name);
  set.Add({"--server", "Where it answers now"}, request->context.server);
  AddAccessFlags(set, request->context.files);
  set.AddSwitch({"--use", "Ask it from now on"}, request->use);
  set.Example("uplinkctl contexts set hall --token-file ~/.config/uplinkctl/hall.token");
  request->given = [&set](const std::string& flag) { return set.Given(flag); };
}

}  // namespace uplink::ctl
