#include "tools/uplink-fleet/flags.h"

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "schema/model/ids.h"
#include "server/config/units.h"
#include "tools/uplink-fleet/clients.h"
#include "tools/uplink-fleet/robot/gateway.h"
#include "tools/uplink-fleet/twin_flags.h"

namespace uplink::synthetic {
namespace {

constexpr std::size_t kThreadsMax = 64;
/// Of the time for which robots send: after it those join that come late.
constexpr double kLateAfter = 0.75;

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

CLI::Validator IsRuriPrefix() {
  return {[](std::string& text) {
            // What comes behind it is /robot- and a number.
            constexpr std::size_t kBytesMax = model::kRuriBytesMax - 16;
            const bool good = text.starts_with("rcan://") && text.size() <= kBytesMax;
            return good ? std::string()
                        : "\"" + text + "\" is not rcan://... of at most " +
                              std::to_string(kBytesMax) + " bytes";
          },
          "RURI"};
}

CLI::Validator IsSeed() {
  return {[](std::string& text) {
            const bool good = !text.empty() && text.size() <= 18 &&
                              text.find_first_not_of("0123456789") == std::string::npos;
            return good ? std::string() : "\"" + text + "\" is not a number of up to 18 digits";
          },
          "NUMBER"};
}

template <typename Number>
CLI::Option* AddNumber(CLI::App& app, const std::string& flag, Number& value,
                       const ScenarioNumber& limits, const std::string& text) {
  return app.add_option(flag, value, text)
      ->capture_default_str()
      ->check(CLI::Range(static_cast<Number>(limits.min), static_cast<Number>(limits.max)));
}

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
  explicit ScenarioFlags(CLI::App& app) {
    app.add_option("--scenario", name_, ScenarioHelp())->capture_default_str();
    robots_ = AddNumber(app, "--robots", given_.robots, kRobotsNumber, "How many");
    declining_ = AddNumber(app, "--declining-share", given_.declining_share, kDecliningNumber,
                           "Share of the robots that decline what others share");
    late_ = AddNumber(app, "--late-share", given_.late_share, kLateNumber,
                      "Share of the robots that join in the last quarter of the run");
    Phase& phase = given_.phases.front();
    rate_ = AddNumber(app, "--rate", phase.options.rate_hz, kRateNumber,
                      "Motion messages per second and robot");
    faults_ = AddNumber(app, "--faults", phase.options.faults_hz, kFaultsNumber,
                        "Fault reports per second and robot");
    pace_ = AddNumber(app, "--pace", phase.options.pace, kPaceNumber,
                      "How many times as often everything but motion, status and faults comes");
    rcan_ = AddNumber(app, "--rcan-share", phase.options.rcan_share, kRcanNumber,
                      "Share of the robots that send RCAN Robot States with six joints");
    batch_ = AddNumber(app, "--batch", phase.batch, kBatchNumber,
                       "Messages that are gathered for one frame, for at most 1 s");
    malformed_ =
        AddNumber(app, "--malformed-share", phase.options.malformed_share, kMalformedNumber,
                  "Share of ticks in which an invalid message is sent, too");
    breaks_ = AddNumber(app, "--breaks-per-minute", phase.trouble.breaks_per_minute, kBreaksNumber,
                        "How often each robot breaks its stream off");
  }

  [[nodiscard]] absl::StatusOr<Scenario> Read() const {
    absl::StatusOr<Scenario> scenario = LoadScenario(name_);
    if (!scenario.ok()) return scenario;
    if (robots_->count() > 0) scenario->robots = given_.robots;
    if (declining_->count() > 0) scenario->declining_share = given_.declining_share;
    if (late_->count() > 0) scenario->late_share = given_.late_share;
    const Phase& given = given_.phases.front();
    for (Phase& phase : scenario->phases) {
      ScenarioOptions& options = phase.options;
      if (rate_->count() > 0) options.rate_hz = given.options.rate_hz;
      if (faults_->count() > 0) options.faults_hz = given.options.faults_hz;
      if (pace_->count() > 0) options.pace = given.options.pace;
      if (rcan_->count() > 0) options.rcan_share = given.options.rcan_share;
      if (batch_->count() > 0) phase.batch = given.batch;
      if (malformed_->count() > 0) options.malformed_share = given.options.malformed_share;
      if (breaks_->count() > 0) {
        phase.trouble.breaks_per_minute = given.trouble.breaks_per_minute;
      }
    }
    return scenario;
  }

 private:
  std::string name_ = "calm";
  Scenario given_;
  CLI::Option* robots_;
  CLI::Option* declining_;
  CLI::Option* late_;
  CLI::Option* rate_;
  CLI::Option* faults_;
  CLI::Option* pace_;
  CLI::Option* rcan_;
  CLI::Option* batch_;
  CLI::Option* malformed_;
  CLI::Option* breaks_;
};

/// Where the run is, how long it goes on, and how it reports.
class RunFlags {
 public:
  explicit RunFlags(CLI::App& app) {
    swarm_.ruri_prefix = "rcan://local.rcan/uplink/synthetic/1.0";
    swarm_.pki_directory = "./pki";
    swarm_.target = "localhost:7443";
    AddPlace(app);
    AddRun(app);
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
    options.swarm.late_after =
        std::chrono::duration_cast<milliseconds>(options.run_for * kLateAfter);
    options.json = report_ == "json";
    return options;
  }

  [[nodiscard]] const std::string& client() const { return client_; }

 private:
  void AddPlace(CLI::App& app) {
    app.add_option("--target", swarm_.target, "The server's relay listener")
        ->capture_default_str()
        ->check(IsAddress());
    app.add_option("--http", options_.http, "The server's HTTP listener, for the comparison")
        ->capture_default_str()
        ->check(IsAddress());
    app.add_option("--pki", swarm_.pki_directory,
                   "Folder with ca.crt and ca.key, which sign the robots")
        ->capture_default_str();
    app.add_option("--fleet", swarm_.fleet, "Fleet of the robots")->capture_default_str();
    app.add_option("--ruri-prefix", swarm_.ruri_prefix, "What comes before /robot-0001")
        ->capture_default_str()
        ->check(IsRuriPrefix());
  }

  void AddRun(CLI::App& app) {
    app.add_option("--for", run_for_, "How long to send; SIGINT or SIGTERM ends it sooner")
        ->capture_default_str()
        ->check(IsDuration());
    app.add_option("--settle-for", settle_for_, "How long the server may take to settle all of it")
        ->capture_default_str()
        ->check(IsDuration());
    app.add_option("--seed", seed_, "The same seed sends the same messages")
        ->capture_default_str()
        ->check(IsSeed());
    app.add_option("--threads", swarm_.threads, "Threads that drive the robots")
        ->capture_default_str()
        ->check(CLI::Range(std::size_t{1}, kThreadsMax));
    app.add_option(
           "--gateways", swarm_.gateways,
           "Gateways through which the robots speak, in equal parts of at most 256; 0: each "
           "robot by itself")
        ->capture_default_str();
    app.add_option("--client", client_,
                   "What the robots speak by: \"own\", a client for thousands of connections, or "
                   "\"grpc\", the gRPC library with the client that protoc makes")
        ->capture_default_str()
        ->check(CLI::IsMember(ClientNames()));
    app.add_option("--report", report_, "Form of the report")
        ->capture_default_str()
        ->check(CLI::IsMember({"text", "json"}));
  }

  RunOptions options_;
  SwarmOptions swarm_;
  std::string run_for_ = "30s";
  std::string settle_for_ = "60s";
  std::string report_ = "text";
  std::string client_ = "own";
  std::string seed_ = "1";
};

/// Says what is wrong; nothing may be.
std::nullopt_t Refuse(std::string_view why, int& code) {
  fmt::print(stderr, "uplink-fleet: {}\n", why);
  code = kExitWrongUse;
  return std::nullopt;
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
  CLI::App app(
      "Synthetic robots: load, faults, and the comparison of what they sent with what the "
      "server counted and stored",
      "uplink-fleet");
  app.set_version_flag("--version", "uplink-fleet " UPLINK_VERSION);
  RunFlags run_flags(app);
  ScenarioFlags scenario_flags(app);
  TwinFlags twin_flags(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    code = app.exit(error) == 0 ? kExitDone : kExitWrongUse;
    return std::nullopt;
  }
  const absl::StatusOr<Scenario> scenario = scenario_flags.Read();
  if (!scenario.ok()) {
    return Refuse(fmt::format("--scenario: {}", std::string(scenario.status().message())), code);
  }
  auto twins = twin_flags.Read(scenario->robots);
  if (!twins.ok()) return Refuse(std::string(twins.status().message()), code);
  RunOptions options = run_flags.Read(*scenario, *std::move(twins));
  if (absl::Status fits = GatewaysFit(options.swarm); !fits.ok()) {
    return Refuse(std::string(fits.message()), code);
  }
  if (absl::Status able = UseClient(run_flags.client(), options.swarm); !able.ok()) {
    return Refuse(std::string(able.message()), code);
  }
  return options;
}

}  // namespace uplink::synthetic
