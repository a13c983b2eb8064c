#include "tools/uplink-fleet/swarm.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <random>
#include <thread>
#include <utility>

#include <fmt/core.h>
#include <grpc/support/log.h>
#include <pthread.h>

#include "tools/pki/directory.h"
#include "tools/uplink-fleet/robot.h"

namespace uplink::synthetic {
namespace {

/// Robots that connect a second at most: a handshake costs the server about 1.5 ms of a core.
constexpr std::int64_t kConnectsASecond = 200;
constexpr int kCertificateDays = 30;

model::SessionId RandomSession(std::random_device& random) {
  std::array<std::uint8_t, model::SessionId::kBytes> bytes{};
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(random());
  }
  return model::SessionId(bytes);
}

/// Hands tags back until the queue is drained.
void Drive(grpc::CompletionQueue& queue) {
  void* tag = nullptr;
  bool ok = false;
  while (queue.Next(&tag, &ok)) {
    static_cast<Tag*>(tag)->Proceed(ok);
  }
}

/// Hands tags back until every robot of this queue is done.
void DriveUntilDone(grpc::CompletionQueue& queue, const std::vector<Robot*>& robots) {
  void* tag = nullptr;
  bool ok = false;
  std::size_t done = 0;
  while (done < robots.size() && queue.Next(&tag, &ok)) {
    static_cast<Tag*>(tag)->Proceed(ok);
    // Robots finish rarely; counting from the last known is cheap.
    while (done < robots.size() && robots[done]->done()) ++done;
  }
  queue.Shutdown();
  Drive(queue);
}

}  // namespace

struct Swarm::Inside {
  std::vector<std::unique_ptr<grpc::CompletionQueue>> queues;
  std::vector<std::unique_ptr<Robot>> robots;
  std::vector<std::jthread> threads;
};

std::string RuriOf(const SwarmOptions& options, std::size_t index) {
  return fmt::format("{}/robot-{:04}", options.ruri_prefix, index + 1);
}

Swarm::Swarm(std::unique_ptr<Inside> inside) : inside_(std::move(inside)) {}
Swarm::~Swarm() = default;

absl::StatusOr<std::unique_ptr<Swarm>> Swarm::Create(const SwarmOptions& options,
                                                     const Clock& clock, Shared& shared) {
  // What ends a stream is counted and reported; gRPC's own lines would go through the live summary.
  gpr_set_log_function([](gpr_log_func_args* /*line*/) {});
  const auto authority = pki::Directory(options.pki_directory).LoadAuthority();
  if (!authority.ok()) return authority.status();
  std::random_device random;
  auto inside = std::make_unique<Inside>();
  for (std::size_t i = 0; i < options.threads; ++i) {
    inside->queues.push_back(std::make_unique<grpc::CompletionQueue>());
  }
  const double tick_ms = std::max(1.0, 1000.0 / options.scenario.rate_hz);
  for (std::size_t i = 0; i < options.robots; ++i) {
    const auto profile =
        pki::RobotProfile(RuriOf(options, i), options.fleet, fmt::format("robot-{:04}", i + 1));
    if (!profile.ok()) return profile.status();
    auto credentials = (*authority)->Issue(*profile, kCertificateDays);
    if (!credentials.ok()) return credentials.status();
    RobotOptions robot;
    robot.target = options.target;
    robot.ruri = RuriOf(options, i);
    robot.credentials = std::move(*credentials);
    robot.ca_pem = (*authority)->credentials().certificate_pem;
    robot.tick = milliseconds(static_cast<std::int64_t>(tick_ms));
    robot.breaks_per_minute = options.breaks_per_minute;
    robot.seed = options.scenario.seed * 1'000'003 + i;
    Agent agent(options.scenario, i, options.batch, RandomSession(random), shared);
    inside->robots.push_back(std::make_unique<Robot>(
        std::move(robot), std::move(agent), *inside->queues[i % options.threads], clock, shared));
  }
  return std::unique_ptr<Swarm>(new Swarm(std::move(inside)));
}

void Swarm::Start() {
  const std::size_t queues = inside_->queues.size();
  for (std::size_t i = 0; i < inside_->robots.size(); ++i) {
    inside_->robots[i]->Start(milliseconds(static_cast<std::int64_t>(i) * 1000 / kConnectsASecond));
  }
  for (std::size_t q = 0; q < queues; ++q) {
    std::vector<Robot*> mine;
    for (std::size_t i = q; i < inside_->robots.size(); i += queues) {
      mine.push_back(inside_->robots[i].get());
    }
    inside_->threads.emplace_back([&queue = *inside_->queues[q], mine = std::move(mine)] {
      pthread_setname_np(pthread_self(), "robots");
      DriveUntilDone(queue, mine);
    });
  }
}

std::vector<RobotOutcome> Swarm::Finish() {
  inside_->threads.clear();
  std::vector<RobotOutcome> outcomes;
  outcomes.reserve(inside_->robots.size());
  for (const auto& robot : inside_->robots) {
    outcomes.push_back(robot->TakeOutcome());
  }
  return outcomes;
}

}  // namespace uplink::synthetic
