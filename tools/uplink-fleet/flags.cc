#include "tools/uplink-fleet/flags.h"

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <absl/status/statusor.h>
#include <fmt/core.h>

#include "schema/model/ids.h"
#include "server/config/flags.h"
#include "server/config/units.h"
#include "server/config/version.h"
#include "tools/link/http_client.h"
#include "tools/uplink-fleet/clients.h"
#include "tools/uplink-fleet/http_flags.h"
#include "tools/uplink-fleet/robot/gateway.h"
#include "tools/uplink-fleet/twin_flags.h"

namespace uplink::synthetic {
namespace {

constexpr std::size_t kThreadsMax = 64;
/// Of the time for which robots send: after it those join that come late.
constexpr double kLateAfter = 0.75;

config::FlagForm IsDuration() {
  return {"DURATION", [](const std::string& text) {
            const auto duration = config::ParseDuration(text);
            return duration && duration->count() > 0
                       ? std::string()
                       : "\"" + text + "\" is not a duration such as 30s or 2m";
          }};
}

config::FlagForm IsRuriPrefix() {
  return {"RURI", [](const std::string& text) {
            // What comes behind it is /robot- and a number.
            constexpr std::size_t kBytesMax = model::kRuriBytesMax - 16;
            const bool good = text.starts_with("rcan://") && text.size() <= kBytesMax;
            return good ? std::string()
                        : "\"" + text + "\" is not rcan://... of at most " +
                              std::to_string(kBytesMax) + " bytes";
          }};
}

config::FlagForm IsSeed() {
  return {"NUMBER", [](const std::string& text) {
            const bool good = !text.empty() && text.size() <= 18 &&
                              text.find_first_not_of("0123456789") == std::string::npos;
            return good ? std::string() : "\"" + text + "\" is not a number of up to 18 digits";
          }};
}

config::FlagRange RangeOf(const ScenarioNumber& number) { return {number.min, number.max}; }

std::string ScenarioHelp() {
  std::string text = "A TOML file, or one that is built in:";
  for (const std::string& name : ScenarioNames()) {
    const auto scenario = LoadScenario(name);
    text += "\n" + name + ": " + (scenario.ok() ? scenario->about : "");
  }
  return text;
}

/// The flags that a scenario sets; a flag that is given goes before it.
class ScenarioFlags {
 public:
  explicit ScenarioFlags(config::Flags& flags) {
    flags.Add({"--scenario", ScenarioHelp()}, name_);
    flags.Add({"--robots", "How many"}, given_.robots, RangeOf(kRobotsNumber));
    flags.Add({"--declining-share", "Share of the robots that decline what others share"},
              given_.declining_share, RangeOf(kDecliningNumber));
    flags.Add({"--late-share", "Share of the robots that join in the last quarter of the run"},
              given_.late_share, RangeOf(kLateNumber));
    Phase& phase = given_.phases.front();
    flags.Add({"--rate", "Motion messages per second and robot"}, phase.options.rate_hz,
              RangeOf(kRateNumber));
    flags.Add({"--faults", "Fault reports per second and robot"}, phase.options.faults_hz,
              RangeOf(kFaultsNumber));
    flags.Add({"--pace", "How many times as often everything but motion, status and faults comes"},
              phase.options.pace, RangeOf(kPaceNumber));
    flags.Add({"--rcan-share", "Share of the robots that send RCAN Robot States with six joints"},
              phase.options.rcan_share, RangeOf(kRcanNumber));
    flags.Add({"--batch", "Messages that are gathered for one frame, for at most 1 s"}, phase.batch,
              RangeOf(kBatchNumber));
    flags.Add({"--malformed-share", "Share of ticks in which an invalid message is sent, too"},
              phase.options.malformed_share, RangeOf(kMalformedNumber));
    flags.Add({"--breaks-per-minute", "How often each robot breaks its stream off"},
              phase.trouble.breaks_per_minute, RangeOf(kBreaksNumber));
    flags.Add({"--lost-answers", "Share of a drone's calls whose answer it does not read"},
              phase.trouble.lost_answers, RangeOf(kLostAnswersNumber));
  }

  [[nodiscard]] absl::StatusOr<Scenario> Read(const config::Flags& flags) const {
    absl::StatusOr<Scenario> scenario = LoadScenario(name_);
    if (!scenario.ok()) return scenario;
    if (flags.Given("--robots")) scenario->robots = given_.robots;
    if (flags.Given("--declining-share")) scenario->declining_share = given_.declining_share;
    if (flags.Given("--late-share")) scenario->late_share = given_.late_share;
    const Phase& given = given_.phases.front();
    for (Phase& phase : scenario->phases) {
      ScenarioOptions& options = phase.options;
      if (flags.Given("--rate")) options.rate_hz = given.options.rate_hz;
      if (flags.Given("--faults")) options.faults_hz = given.options.faults_hz;
      if (flags.Given("--pace")) options.pace = given.options.pace;
      if (flags.Given("--rcan-share")) options.rcan_share = given.options.rcan_share;
      if (flags.Given("--batch")) phase.batch = given.batch;
      if (flags.Given("--malformed-share")) options.malformed_share = given.options.malformed_share;
      if (flags.Given("--breaks-per-minute")) {
        phase.trouble.breaks_per_minute = given.trouble.breaks_per_minute;
      }
      if (flags.Given("--lost-answers")) phase.trouble.lost_answers = given.trouble.lost_answers;
    }
    return scenario;
  }

 private:
  std::string name_ = "calm";
  Scenario given_;
};

/// Where the run is, how long it goes on, and how it reports.
class RunFlags {
 public:
  explicit RunFlags(config::Flags& flags) {
    swarm_.ruri_prefix = "rcan://local.rcan/uplink/synthetic/1.0";
    swarm_.pki_directory = "./pki";
    swarm_.target = "localhost:7443";
    AddPlace(flags);
    AddRun(flags);
  }

  /// For robots of this scenario, or for these twins.
  [[nodiscard]] RunOptions Read(const Scenario& scenario,
                                std::optional<TwinSwarmOptions> twins) const {
    RunOptions options = options_;
    options.swarm = swarm_;
    options.swarm.scenario = scenario;
    options.twins = std::move(twins);
    options.seed = std::stoull(seed_);
    options.run_for = config::ParseDuration(run_for_).value_or(options.run_for);
    options.settle_for = config::ParseDuration(settle_for_).value_or(options.settle_for);
    options.swarm.parked_for = config::ParseDuration(parked_for_).value_or(milliseconds(0));
    options.swarm.late_after =
        std::chrono::duration_cast<milliseconds>(options.run_for * kLateAfter);
    options.json = report_ == "json";
    options.drones = protocol_ == kDroneProtocol;
    return options;
  }

  [[nodiscard]] const std::string& client() const { return client_; }
  [[nodiscard]] const HttpFlags& http() const { return *http_; }

 private:
  void AddPlace(config::Flags& flags) {
    flags.Add({"--target", "The server's relay listener"}, swarm_.target, IsAddress());
    http_.emplace(flags);
    flags.AddSwitch({"--acks-only",
                     "Compare nothing over HTTP: it suffices that the robots get an ack for each "
                     "durable message"},
                    options_.acks_only);
    flags.Add({"--pki", "Folder with ca.crt and ca.key, which sign the robots"},
              swarm_.pki_directory);
    flags.Add({"--fleet", "Fleet of the robots"}, swarm_.fleet);
    flags.Add({"--ruri-prefix", "What comes before /robot-0001"}, swarm_.ruri_prefix,
              IsRuriPrefix());
  }

  void AddRun(config::Flags& flags) {
    flags.Add({"--for", "How long to send; SIGINT or SIGTERM ends it sooner"}, run_for_,
              IsDuration());
    flags.Add({"--settle-for", "How long the server may take to settle all of it"}, settle_for_,
              IsDuration());
    flags.Add(
        {"--parked",
         "Each robot says Goodbye at its end, and is parked for so long; left out: none does"},
        parked_for_, IsDuration());
    flags.Add({"--seed", "The same seed sends the same messages"}, seed_, IsSeed());
    flags.Add({"--threads", "Threads that drive the robots"}, swarm_.threads, {1, kThreadsMax});
    flags.Add({"--gateways",
               "Gateways through which the robots speak, in equal parts of at most 256; 0: each "
               "robot by itself"},
              swarm_.gateways);
    flags.AddChoice({"--client",
                     "What the robots speak by: \"own\", a client for thousands of connections, or "
                     "\"grpc\", the gRPC library with the client that protoc makes"},
                    client_, ClientNames());
    flags.AddChoice(
        {"--protocol",
         "\"uplink\": robots that stream on the relay, or \"uncrew\": drones that call "
         "AvatarService there; of the other flags --target, --http*, --pki, "
         "--fleet, --robots, --scenario, --faults, --malformed-share, --breaks-per-minute, "
         "--lost-answers, --for, --settle-for, --seed, --threads and --report count"},
        protocol_, ProtocolNames());
    flags.AddChoice({"--report", "Form of the report"}, report_, {"text", "json"});
  }

  RunOptions options_;
  std::optional<HttpFlags> http_;
  SwarmOptions swarm_;
  std::string run_for_ = "30s";
  std::string settle_for_ = "60s";
  std::string parked_for_;
  std::string report_ = "text";
  std::string client_ = "own";
  std::string protocol_ = kRelayProtocol;
  std::string seed_ = "1";
};

/// Says what is wrong; nothing may be.
std::nullopt_t Refuse(std::string_view why, int& code) {
  fmt::print(stderr, "uplink-fleet: {}\n", why);
  code = kExitWrongUse;
  return std::nullopt;
}

/// Drones and twins are compared over HTTP only.
absl::Status AcksFit(const RunOptions& options) {
  if (!options.acks_only || (!options.drones && !options.twins)) return absl::OkStatus();
  return absl::InvalidArgumentError("--acks-only: it is for robots on the relay");
}

/// Drones have neither gateways nor a broker.
absl::Status DronesFit(const RunOptions& options) {
  if (!options.drones || (options.swarm.gateways == 0 && !options.twins)) return absl::OkStatus();
  return absl::InvalidArgumentError("--protocol uncrew: it has no --gateways and no --cyberwave");
}

absl::Status GatewaysFit(const SwarmOptions& swarm) {
  const std::size_t robots = swarm.scenario.robots;
  if (swarm.gateways == 0) return absl::OkStatus();
  if (swarm.gateways <= robots && robots <= swarm.gateways * kRobotsPerGateway) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(
      fmt::format("--gateways: {} for {} robots; a gateway has 1 to {} of them", swarm.gateways,
                  robots, kRobotsPerGateway));
}

}  // namespace

std::optional<RunOptions> ReadFlags(int argc, char** argv, int& code) {
  config::Flags flags(
      "Synthetic robots: load, faults, and the comparison of what they sent with what the "
      "server counted and stored",
      "uplink-fleet", config::VersionText());
  RunFlags run_flags(flags);
  ScenarioFlags scenario_flags(flags);
  TwinFlags twin_flags(flags);
  flags.Example("uplink-fleet --robots 100 --for 1m");
  flags.Example("uplink-fleet --scenario rough --target localhost:7443 --pki ./pki");
  if (const auto ended = flags.Parse(argc, argv)) {
    code = *ended;
    return std::nullopt;
  }
  const absl::StatusOr<Scenario> scenario = scenario_flags.Read(flags);
  if (!scenario.ok()) {
    return Refuse(fmt::format("--scenario: {}", std::string(scenario.status().message())), code);
  }
  auto twins = twin_flags.Read(scenario->robots);
  if (!twins.ok()) return Refuse(std::string(twins.status().message()), code);
  RunOptions options = run_flags.Read(*scenario, *std::move(twins));
  if (absl::Status fits = GatewaysFit(options.swarm); !fits.ok()) {
    return Refuse(std::string(fits.message()), code);
  }
  if (absl::Status fits = DronesFit(options); !fits.ok()) {
    return Refuse(std::string(fits.message()), code);
  }
  if (absl::Status fits = AcksFit(options); !fits.ok()) {
    return Refuse(std::string(fits.message()), code);
  }
  absl::StatusOr<link::HttpServer> http = run_flags.http().Read();
  if (!http.ok()) return Refuse(std::string(http.status().message()), code);
  options.http = *std::move(http);
  if (absl::Status able = UseClient(run_flags.client(), options.swarm); !able.ok()) {
    return Refuse(std::string(able.message()), code);
  }
  return options;
}

}  // namespace uplink::synthetic
