#include <cstdio>
#include <memory>
#include <string>

#include <fmt/core.h>

#include "server/config/load.h"
#include "tools/uplinkctl/command.h"
#include "tools/uplinkctl/listeners.h"
#include "tools/uplinkctl/probe.h"

namespace uplink::ctl {
namespace {

struct Arguments {
  bool ready = false;
  std::string url;
  std::string config;
};

/// Where the server of that file listens; without a file, one that is started with the defaults
/// and the variables of this environment.
absl::StatusOr<std::string> AddressOfConfig(const std::string& path) {
  const config::Environment environment = config::ProcessEnvironment();
  const config::LoadResult read = path.empty() ? config::ParseConfig("", "defaults", environment)
                                               : config::LoadConfig(path, environment);
  if (!read.readable) {
    return absl::InvalidArgumentError(
        read.problems.empty() ? path + " cannot be read" : config::ToText(read.problems.front()));
  }
  const config::ListenAddress address = ProbeAddress(*read.readable);
  if (address.port == 0) {
    return absl::InvalidArgumentError(
        "the server takes any free port (listen.http ends with :0): name it by --url");
  }
  return config::ToText(address);
}

int Health(const Arguments& arguments) {
  const absl::StatusOr<std::string> address =
      arguments.url.empty() ? AddressOfConfig(arguments.config) : AddressOfUrl(arguments.url);
  if (!address.ok()) return ExitOf(address.status());
  const Probe probe = arguments.ready ? Probe::kReady : Probe::kAlive;
  link::HttpClient client(*address, {kProbeDeadline, kProbeBytesMax});
  const absl::StatusOr<link::HttpAnswer> answer = client.Ask(ProbePath(probe));
  if (!answer.ok()) return ExitOf(answer.status());
  const ProbeWord word = JudgeAnswer(probe, *answer);
  fmt::print(word.good ? stdout : stderr, "{}\n", word.line);
  return word.good ? kExitDone : kExitFailed;
}

}  // namespace

void AddHealth(config::Flags& program) {
  const auto arguments = std::make_shared<Arguments>();
  config::Flags& noun = program.AddCommand(
      "health", "Ask a server whether it is alive, in one line; 1 if it is not, or does not answer",
      [arguments] { return Health(*arguments); });
  noun.AddSwitch({"--ready", "Ask whether it is ready for traffic instead"}, arguments->ready);
  noun.Add({"--url", "Where it answers probes: http://HOST:PORT"}, arguments->url);
  noun.Add({"--config", "The server's configuration file, which says where it listens"},
           arguments->config);
  noun.AtMostOne({"--url", "--config"});
}

}  // namespace uplink::ctl
