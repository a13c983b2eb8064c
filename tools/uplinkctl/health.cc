#include <cstdio>
#include <memory>
#include <string>

#include <fmt/core.h>

#include "server/config/load.h"
#include "tools/uplinkctl/ask/access.h"
#include "tools/uplinkctl/command.h"
#include "tools/uplinkctl/probe.h"
#include "tools/uplinkctl/probe_target.h"

namespace uplink::ctl {
namespace {

struct Arguments {
  bool ready = false;
  std::string url;
  std::string config;
};

absl::StatusOr<ProbeTarget> TargetOf(const Arguments& arguments) {
  if (!arguments.url.empty()) return TargetOfUrl(arguments.url);
  const config::Environment environment = config::ProcessEnvironment();
  return arguments.config.empty() ? TargetWithoutFlags(config::kConfigFileDefault, environment)
                                  : TargetOfConfig(arguments.config, environment);
}

int Health(const Arguments& arguments) {
  const absl::StatusOr<ProbeTarget> target = TargetOf(arguments);
  if (!target.ok()) return ExitOf(target.status());
  const absl::StatusOr<link::HttpServer> server = ServerToProbe(target->url);
  if (!server.ok()) return ExitOf(server.status());
  const Probe probe = arguments.ready ? Probe::kReady : Probe::kAlive;
  link::HttpClient client(*server, {kProbeDeadline, kProbeBytesMax});
  const absl::StatusOr<link::HttpAnswer> answer = client.Ask(target->url.prefix + ProbePath(probe));
  if (!answer.ok()) return ExitOf(WithSource(answer.status(), *target));
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
  noun.Add({"--url,--server", fmt::format("Where it answers probes: {}; of https any certificate "
                                          "will do",
                                          kUrlForms)},
           arguments->url);
  noun.Add({"--config", fmt::format("The server's configuration file, which says where it listens "
                                    "(without --url: {}, if it can be read)",
                                    config::kConfigFileDefault)},
           arguments->config);
  noun.AtMostOne({"--url", "--config"});
  noun.Example("uplinkctl health --ready --config /etc/uplinkd/uplinkd.toml");
}

}  // namespace uplink::ctl
