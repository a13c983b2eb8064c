#include "tools/uplink-fleet/flags.h"

#include <CLI/CLI.hpp>

#include "server/config/units.h"

namespace uplink::synthetic {
namespace {

constexpr double kRateHzMax = 1000;
constexpr double kBreaksMax = 600;
constexpr std::size_t kThreadsMax = 64;
constexpr std::size_t kBatchMax = 256;

CLI::Validator IsDuration() {
  return {[](std::string& text) {
            const auto duration = config::ParseDuration(text);
            return duration && duration->count() > 0
                       ? std::string()
                       : "\"" + text + "\" is not a duration such as 30s or 2m";
          },
          "DURATION"};
}

CLI::Validator IsAddress() {
  return {[](std::string& text) {
            const std::size_t colon = text.rfind(':');
            const bool good = colon != std::string::npos && colon > 0 && colon + 1 < text.size() &&
                              text.find_first_not_of("0123456789", colon + 1) == std::string::npos;
            return good ? std::string() : "\"" + text + "\" is not HOST:PORT";
          },
          "HOST:PORT"};
}

}  // namespace

std::optional<Flags> ReadFlags(int argc, char** argv, int& code) {
  Flags flags;
  SwarmOptions& swarm = flags.swarm;
  swarm.ruri_prefix = "rcan://local.rcan/uplink/synthetic/1.0";
  swarm.pki_directory = "./pki";
  swarm.target = "localhost:7443";
  std::string run_for = "30s";
  std::string settle_for = "60s";
  std::string report = "text";
  CLI::App app(
      "Synthetic robots: load, faults, and the comparison of what they sent with what the "
      "server counted and stored",
      "uplink-fleet");
  app.set_version_flag("--version", "uplink-fleet " UPLINK_VERSION);
  app.add_option("--target", swarm.target, "The server's relay listener")
      ->capture_default_str()
      ->check(IsAddress());
  app.add_option("--http", flags.http, "The server's HTTP listener, to verify")
      ->capture_default_str()
      ->check(IsAddress());
  app.add_option("--pki", swarm.pki_directory,
                 "Folder with ca.crt and ca.key, which sign the robots")
      ->capture_default_str();
  app.add_option("--robots", swarm.robots)
      ->capture_default_str()
      ->check(CLI::Range(std::size_t{1}, kRobotsMax));
  app.add_option("--fleet", swarm.fleet, "Fleet of the robots")->capture_default_str();
  app.add_option("--ruri-prefix", swarm.ruri_prefix, "What comes before /robot-0001")
      ->capture_default_str();
  app.add_option("--for", run_for, "How long to send; SIGINT or SIGTERM ends it sooner")
      ->capture_default_str()
      ->check(IsDuration());
  app.add_option("--settle-for", settle_for, "How long the server may take to settle all of it")
      ->capture_default_str()
      ->check(IsDuration());
  app.add_option("--seed", swarm.scenario.seed)->capture_default_str();
  app.add_option("--rate", swarm.scenario.rate_hz, "Motion messages a second and robot")
      ->capture_default_str()
      ->check(CLI::Range(0.1, kRateHzMax));
  app.add_option("--faults", swarm.scenario.faults_hz, "Fault reports a second and robot")
      ->capture_default_str()
      ->check(CLI::Range(0.0, kRateHzMax));
  app.add_option("--batch", swarm.batch, "Messages that are gathered for a frame, up to 1 s")
      ->capture_default_str()
      ->check(CLI::Range(std::size_t{1}, kBatchMax));
  app.add_option("--malformed-share", swarm.scenario.malformed_share,
                 "Share of motion messages in whose place something wrong is sent")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--breaks-per-minute", swarm.breaks_per_minute,
                 "How often a robot breaks its stream off")
      ->capture_default_str()
      ->check(CLI::Range(0.0, kBreaksMax));
  app.add_option("--threads", swarm.threads)
      ->capture_default_str()
      ->check(CLI::Range(std::size_t{1}, kThreadsMax));
  app.add_option("--report", report)->capture_default_str()->check(CLI::IsMember({"text", "json"}));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    code = app.exit(error) == 0 ? kExitDone : kExitWrongUse;
    return std::nullopt;
  }
  flags.run_for = config::ParseDuration(run_for).value_or(flags.run_for);
  flags.settle_for = config::ParseDuration(settle_for).value_or(flags.settle_for);
  flags.json = report == "json";
  return flags;
}

}  // namespace uplink::synthetic
