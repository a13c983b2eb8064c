#include "tools/uplink-fleet/robot/swarm.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <latch>
#include <map>
#include <mutex>
#include <random>
#include <thread>
#include <utility>

#include <fmt/core.h>
#include <pthread.h>

#include "tools/link/loop.h"
#include "tools/pki/directory.h"
#include "tools/uplink-fleet/robot/robot.h"

namespace uplink::synthetic {
namespace {

constexpr int kCertificateDays = 30;

model::SessionId RandomSession(std::random_device& random) {
  std::array<std::uint8_t, model::SessionId::kBytes> bytes{};
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(random());
  }
  return model::SessionId(bytes);
}

/// One thread's robots. Members are destroyed in reverse: robots before the loop they hang on.
struct Driver {
  link::Loop loop;
  Latencies latencies;
  /// By their places among all; none without them.
  std::map<std::size_t, std::unique_ptr<Gateway>> gateways;
  ForwardReader forwards;
  std::vector<std::unique_ptr<Robot>> robots;
  /// Their places in the fleet.
  std::vector<std::size_t> indices;
};

}  // namespace

struct Swarm::Inside {
  SwarmOptions options;
  const Clock& clock;
  Shared& shared;
  std::unique_ptr<pki::Authority> authority;
  std::shared_ptr<const link::TlsClient> tls;
  link::Address address;
  /// Of each gateway, or else of each robot.
  std::vector<link::Identity> identities;
  /// Of each robot, with options.dial.
  std::vector<link::DialOptions> dialled;
  std::vector<model::SessionId> sessions;
  std::vector<std::unique_ptr<Driver>> drivers;
  /// When all threads have made their agents, the run begins for all robots at once.
  std::latch made{static_cast<std::ptrdiff_t>(options.threads)};
  std::once_flag began;
  SteadyTime start{};
  std::vector<std::jthread> threads;

  /// On the driver's own thread: a robot that was offline first lives through that time.
  [[nodiscard]] absl::Status Issue(const absl::StatusOr<pki::Profile>& profile);
  [[nodiscard]] absl::Status IssueAll();
  /// The robot's connection: an identity of its own, or its gateway.
  void Connect(std::size_t index, Driver& driver, RobotOptions& robot) const;
  [[nodiscard]] std::vector<Agent> MakeAgents(Driver& driver);
  void MakeRobots(Driver& driver, std::vector<Agent> agents);
};

std::string RuriOf(const SwarmOptions& options, std::size_t index) {
  return fmt::format("{}/robot-{:04}", options.ruri_prefix, index + 1);
}

Swarm::Swarm(std::unique_ptr<Inside> inside) : inside_(std::move(inside)) {}
Swarm::~Swarm() = default;

absl::StatusOr<std::unique_ptr<Swarm>> Swarm::Create(const SwarmOptions& options,
                                                     const Clock& clock, Shared& shared) {
  auto authority = pki::Directory(options.pki_directory).LoadAuthority();
  if (!authority.ok()) return authority.status();
  auto tls =
      link::TlsClient::Create((*authority)->credentials().certificate_pem, link::Alpn::kHttp2);
  if (!tls.ok()) return tls.status();
  auto address = link::Resolve(options.target);
  if (!address.ok()) return address.status();
  std::unique_ptr<Inside> inside(new Inside{.options = options,
                                            .clock = clock,
                                            .shared = shared,
                                            .authority = *std::move(authority),
                                            .tls = *std::move(tls),
                                            .address = *std::move(address)});
  std::random_device random;
  for (std::size_t i = 0; i < options.threads; ++i) {
    inside->drivers.push_back(std::make_unique<Driver>());
  }
  if (const absl::Status issued = inside->IssueAll(); !issued.ok()) return issued;
  for (std::size_t i = 0; i < options.scenario.robots; ++i) {
    inside->sessions.push_back(RandomSession(random));
    // Robots of one gateway are on one thread, with its connection.
    const std::size_t place = options.gateways > 0 ? i % options.gateways : i;
    inside->drivers[place % options.threads]->indices.push_back(i);
  }
  return std::unique_ptr<Swarm>(new Swarm(std::move(inside)));
}

absl::Status Swarm::Inside::Issue(const absl::StatusOr<pki::Profile>& profile) {
  if (!profile.ok()) return profile.status();
  const auto credentials = authority->Issue(*profile, kCertificateDays);
  if (!credentials.ok()) return credentials.status();
  auto identity = link::Identity::Parse(credentials->certificate_pem, credentials->key_pem);
  if (!identity.ok()) return identity.status();
  identities.push_back(*std::move(identity));
  if (options.dial) {
    dialled.push_back({.target = options.target,
                       .server_ca = authority->credentials().certificate_pem,
                       .certificate = credentials->certificate_pem,
                       .key = credentials->key_pem});
  }
  return absl::OkStatus();
}

absl::Status Swarm::Inside::IssueAll() {
  const std::size_t robots = options.scenario.robots;
  for (std::size_t i = 0; options.gateways == 0 && i < robots; ++i) {
    absl::Status status = Issue(
        pki::RobotProfile(RuriOf(options, i), options.fleet, fmt::format("robot-{:04}", i + 1)));
    if (!status.ok()) return status;
  }
  for (std::size_t gateway = 0; gateway < options.gateways; ++gateway) {
    std::vector<std::string> ruris;
    for (std::size_t i = gateway; i < robots; i += options.gateways) {
      ruris.push_back(RuriOf(options, i));
    }
    absl::Status status =
        Issue(pki::GatewayProfile(ruris, options.fleet, fmt::format("gateway-{:04}", gateway + 1)));
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

void Swarm::Inside::Connect(std::size_t index, Driver& driver, RobotOptions& robot) const {
  robot.link.address = address;
  robot.link.tls = tls;
  const bool slow = std::ranges::any_of(options.scenario.phases, [index](const Phase& phase) {
    return ReadsSlowly(phase.trouble, index);
  });
  if (slow) robot.link.window_bytes = kSlowWindowBytes;
  if (options.gateways == 0) {
    robot.link.identity = identities[index];
    robot.dial = options.dial;
    if (options.dial) robot.dialled = dialled[index];
    return;
  }
  const std::size_t place = index % options.gateways;
  robot.leads = index < options.gateways;
  robot.link.identity = identities[place];
  auto& gateway = driver.gateways[place];
  if (gateway == nullptr) gateway = std::make_unique<Gateway>(driver.loop, robot.link, shared);
  robot.gateway = gateway.get();
}

std::vector<Agent> Swarm::Inside::MakeAgents(Driver& driver) {
  const Phase& first = options.scenario.phases.front();
  std::vector<Agent> agents;
  agents.reserve(driver.indices.size());
  for (const std::size_t i : driver.indices) {
    Agent& agent = agents.emplace_back(first, i, sessions[i], shared, driver.latencies);
    agent.Name(RuriOf(options, i));
    if (!Declines(options.scenario, i)) agent.Receive(RuriOf(options, i), driver.forwards);
    if (JoinsLate(options.scenario, i)) agent.JoinLate();
    if (shared.abandon.load()) continue;
    agent.LiveOffline(options.scenario.offline_before, first.tick(), clock.System());
  }
  return agents;
}

void Swarm::Inside::MakeRobots(Driver& driver, std::vector<Agent> agents) {
  const Scenario& scenario = options.scenario;
  for (std::size_t at = 0; at < agents.size(); ++at) {
    const std::size_t i = driver.indices[at];
    RobotOptions robot;
    robot.ruri = RuriOf(options, i);
    robot.index = i;
    Connect(i, driver, robot);
    robot.seed = scenario.phases.front().options.seed * 1'000'003 + i;
    robot.joins_at = JoinsLate(scenario, i) ? start + options.late_after : start;
    robot.parked_for = options.parked_for;
    agents[at].Begin(start);
    driver.robots.push_back(std::make_unique<Robot>(std::move(robot), std::move(agents[at]),
                                                    scenario, start, driver.loop, clock, shared));
    const double after_ms = static_cast<double>(i) * 1000 / scenario.connects_per_second;
    driver.robots.back()->Start(milliseconds(static_cast<std::int64_t>(after_ms)));
  }
}

void Swarm::Start() {
  for (const auto& driver : inside_->drivers) {
    inside_->threads.emplace_back([inside = inside_.get(), &driver = *driver] {
      pthread_setname_np(pthread_self(), "robots");
      std::vector<Agent> agents = inside->MakeAgents(driver);
      inside->made.arrive_and_wait();
      std::call_once(inside->began, [inside] { inside->start = inside->clock.Steady(); });
      inside->MakeRobots(driver, std::move(agents));
      inside->shared.threads_ready.fetch_add(1);
      // Until no robot sets another timer: all are done.
      driver.loop.io.run();
    });
  }
}

std::vector<RobotOutcome> Swarm::Finish() {
  inside_->threads.clear();
  std::vector<RobotOutcome> outcomes;
  outcomes.reserve(inside_->options.scenario.robots);
  for (const auto& driver : inside_->drivers) {
    for (const auto& robot : driver->robots) outcomes.push_back(robot->TakeOutcome());
  }
  return outcomes;
}

Latencies Swarm::TakeLatencies() {
  Latencies all;
  for (const auto& driver : inside_->drivers) all.Merge(driver->latencies);
  return all;
}

std::set<std::string> Swarm::Origins() const {
  std::set<std::string> all;
  for (const auto& driver : inside_->drivers) {
    all.insert(driver->forwards.origins().begin(), driver->forwards.origins().end());
  }
  return all;
}

}  // namespace uplink::synthetic
