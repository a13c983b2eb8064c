#include "tools/uplinkctl/ask/server_choice.h"

#include <utility>

#include <fmt/core.h>
#include <unistd.h>

#include "tools/terminal/terminal.h"
#include "tools/uplinkctl/ask/contexts.h"
#include "tools/uplinkctl/probe_target.h"

namespace uplink::ctl {
namespace {

absl::StatusOr<ServerChoice> OfUrl(const std::string& url, const std::string& named) {
  absl::StatusOr<ServerUrl> parsed = ParseServerUrl(url, named);
  if (!parsed.ok()) return parsed.status();
  return ServerChoice{*std::move(parsed), "that of " + named};
}

absl::StatusOr<ServerChoice> OfContext(const Contexts& contexts, const std::string& name) {
  const auto found = contexts.by_name.find(name);
  if (found != contexts.by_name.end()) {
    absl::StatusOr<ServerChoice> choice = OfUrl(found->second.server, "the context " + name);
    if (choice.ok()) choice->files = found->second.files;
    return choice;
  }
  std::string known;
  for (const auto& [each, context] : contexts.by_name) known += (known.empty() ? "" : ", ") + each;
  return absl::InvalidArgumentError(
      fmt::format("there is no context {}; {}", name,
                  known.empty() ? "add it by uplinkctl contexts add NAME --server URL"
                                : "there are: " + known));
}

absl::StatusOr<ServerChoice> ChooseAddress(const ServerFlags& flags, const ServerSources& sources) {
  if (!flags.server.empty()) return OfUrl(flags.server, "--server");
  if (!flags.config.empty()) {
    absl::StatusOr<ProbeTarget> target = TargetOfConfig(flags.config, sources.environment);
    if (!target.ok()) return target.status();
    return ServerChoice{.url = std::move(target->url),
                        .source = std::move(target->source),
                        .certificate_file = std::move(target->certificate_file)};
  }
  if (flags.context.empty() && !sources.variable.empty()) {
    return OfUrl(sources.variable, fmt::format("the variable {}", kServerVariable));
  }
  const absl::StatusOr<Contexts> contexts = LoadContexts(sources.contexts_file);
  if (!contexts.ok()) return contexts.status();
  if (!flags.context.empty()) return OfContext(*contexts, flags.context);
  if (!contexts->current.empty()) return OfContext(*contexts, contexts->current);
  absl::StatusOr<ServerUrl> url = ParseServerUrl(kServerDefault, "the default");
  if (!url.ok()) return url.status();
  return ServerChoice{*std::move(url), "the default"};
}

}  // namespace

ServerSources ProcessSources() {
  return {std::string(VariableIn(environ, kServerVariable)), ContextsFile(environ),
          config::ProcessEnvironment(), std::string(VariableIn(environ, kTokenVariable))};
}

absl::StatusOr<ServerChoice> ChooseServer(const ServerFlags& flags, const ServerSources& sources) {
  absl::StatusOr<ServerChoice> choice = ChooseAddress(flags, sources);
  if (!choice.ok()) return choice;
  AccessFiles& files = choice->files;
  const AccessFiles& given = flags.files;
  if (!given.ca_file.empty()) files.ca_file = given.ca_file;
  if (!given.certificate_file.empty() || !given.key_file.empty()) {
    files.certificate_file = given.certificate_file;
    files.key_file = given.key_file;
  }
  const bool named = !flags.context.empty() && !files.token_file.empty();
  if (!given.token_file.empty()) {
    files.token_file = given.token_file;
  } else if (!sources.token_file.empty() && !named) {
    files.token_file = sources.token_file;
  }
  return choice;
}

}  // namespace uplink::ctl
