#include "tools/uplink-fleet/drone/group.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <utility>

#include <fmt/core.h>
#include <grpcpp/client_context.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/impl/codegen/proto_utils.h>
#include <grpcpp/security/credentials.h>
#include <grpcpp/support/async_unary_call.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/channel_arguments.h>

#include "tools/uplink-fleet/drone/outbox.h"
#include "tools/uplink-fleet/robot/network_chance.h"

namespace uplink::synthetic {
namespace {

using ::uncrew::v1::PublishResponse;
using Stub = grpc::TemplatedGenericStub<grpc::ByteBuffer, PublishResponse>;

/// One sample of each type.
constexpr milliseconds kSecond{1'000};
/// A turn waits no longer, so that a stage that ends is seen, and a call that is due again.
constexpr milliseconds kTurnMax{20};
/// More than the server takes for an answer (`uncrew.answer_within`).
constexpr milliseconds kAnswerWithin{7'000};
/// A call that is given up at once lives so long at most.
constexpr double kGivenUpMs = 15;
constexpr milliseconds kReconnectMin{100};
constexpr milliseconds kReconnectMax{1'000};
/// Apart from what a drone says.
constexpr std::uint64_t kLinkSalt = 0x6c'696e'6bULL;

std::unique_ptr<Stub> Connect(const DroneDial& dial) {
  grpc::ChannelArguments arguments;
  // A connection of its own, also beside others to the same server.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, static_cast<int>(kReconnectMin.count()));
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, static_cast<int>(kReconnectMax.count()));
  return std::make_unique<Stub>(grpc::CreateCustomChannel(
      dial.target, grpc::SslCredentials({dial.server_ca, dial.key, dial.certificate}), arguments));
}

}  // namespace

struct DroneGroup::Queue {
  grpc::CompletionQueue calls;
};

/// A call on its way.
struct DroneGroup::Attempt {
  Attempt(Drone& of, DroneOutbox::Leaving what) : drone(of), leaving(std::move(what)) {}

  Drone& drone;
  DroneOutbox::Leaving leaving;
  /// No answer of it is taken.
  bool lost = false;
  grpc::ClientContext context;
  PublishResponse answer;
  grpc::Status status;
  std::unique_ptr<grpc::ClientAsyncResponseReader<PublishResponse>> reader;
};

struct DroneGroup::Drone {
  Drone(const DroneOptions& options, DroneDial to, SteadyTime start)
      : script(options),
        outbox(script.lines(), options.seed + options.index),
        dial(std::move(to)),
        stub(Connect(dial)),
        // Not all of them at once.
        due(start + kSecond * static_cast<int>(options.index % 10) / 10),
        chance((options.seed ^ kLinkSalt) + options.index),
        network((options.seed ^ kLinkSalt) + options.index, start) {}

  DroneScript script;
  DroneOutbox outbox;
  DroneDial dial;
  std::unique_ptr<Stub> stub;
  SteadyTime due;
  Seeded chance;
  NetworkChance network;
  std::map<Attempt*, std::unique_ptr<Attempt>> away;
};

DroneGroup::DroneGroup(const Scenario& scenario, const Clock& clock, DronesShared& shared)
    : scenario_(scenario),
      clock_(clock),
      shared_(shared),
      start_(clock.Steady()),
      queue_(std::make_unique<Queue>()) {}
DroneGroup::~DroneGroup() = default;

void DroneGroup::Add(const DroneOptions& options, DroneDial dial) {
  drones_.push_back(std::make_unique<Drone>(options, std::move(dial), start_));
}

std::int64_t DroneGroup::NowUs() const {
  constexpr std::int64_t kUsPerMs = 1'000;
  return UnixMs(clock_.System()) * kUsPerMs;
}

const Phase& DroneGroup::phase(SteadyTime now) const {
  return scenario_.At(std::chrono::duration_cast<milliseconds>(now - start_));
}

void DroneGroup::Run() {
  while (!shared_.abandon.load() && stage_ != DroneStage::kClose) {
    if (const DroneStage stage = shared_.stage.load(); stage != stage_) EnterStage(stage);
    AwaitAnswers();
    const SteadyTime now = clock_.Steady();
    for (const auto& drone : drones_) Work(*drone, now);
    if (told_ || stage_ == DroneStage::kSend || !AllAnswered()) continue;
    told_ = true;
    (stage_ == DroneStage::kLast ? shared_.quiet_groups : shared_.settled_groups).fetch_add(1);
  }
  for (const auto& drone : drones_) CutLink(*drone);
  queue_->calls.Shutdown();
  void* tag = nullptr;
  bool ok = false;
  while (queue_->calls.Next(&tag, &ok)) {
    // What it tells is not asked for any more.
  }
}

void DroneGroup::AwaitAnswers() {
  void* tag = nullptr;
  bool ok = false;
  milliseconds wait = kTurnMax;
  // All that have come: no more than are on their way, since none leaves meanwhile.
  while (queue_->calls.AsyncNext(&tag, &ok,
                                 std::chrono::system_clock::time_point(clock_.System() + wait)) ==
         grpc::CompletionQueue::GOT_EVENT) {
    Done(*static_cast<Attempt*>(tag), clock_.Steady());
    wait = milliseconds(0);
  }
}

void DroneGroup::EnterStage(DroneStage stage) {
  stage_ = stage;
  told_ = false;
  if (stage != DroneStage::kLast) return;
  const SteadyTime now = clock_.Steady();
  for (const auto& drone : drones_) {
    for (AvatarCall& call : drone->script.Last(NowUs())) {
      drone->script.account().Sends(call.number);
      drone->outbox.Add(std::move(call), now);
    }
  }
}

void DroneGroup::Work(Drone& drone, SteadyTime now) {
  if (now >= drone.due) {
    drone.due = std::max(drone.due + kSecond, now);
    const Phase& at = phase(now);
    if (stage_ == DroneStage::kSend) {
      drone.network.Draw(at);
      if (drone.network.Take(at, now) != Mishap::kNone) {
        CutLink(drone);
        drone.stub = Connect(drone.dial);
        shared_.cut.fetch_add(1);
      }
      const auto busy = [&drone](std::size_t line) { return drone.outbox.IsBusy(line); };
      for (AvatarCall& call : drone.script.Second(NowUs(), at.options, busy)) {
        if (!call.live) drone.script.account().Sends(call.number);
        drone.outbox.Add(std::move(call), now);
      }
    } else if (told_ && drone.script.account().answered() > 0) {
      drone.outbox.Add(drone.script.Again(), now);
    }
  }
  Send(drone, now);
}

void DroneGroup::Send(Drone& drone, SteadyTime now) {
  while (auto leaving = drone.outbox.Next(now)) {
    auto attempt = std::make_unique<Attempt>(drone, *std::move(leaving));
    const AvatarCall& call = attempt->leaving.call;
    milliseconds within = kAnswerWithin;
    if (stage_ == DroneStage::kSend && drone.chance.Chance(phase(now).trouble.lost_answers)) {
      attempt->lost = true;
      shared_.lost.fetch_add(1);
      // Of half of them the answer comes, and is not taken; the others may not even arrive.
      if (drone.chance.Chance(0.5)) {
        within = milliseconds(static_cast<std::int64_t>(drone.chance.Between(0, kGivenUpMs)));
      }
    }
    attempt->context.set_wait_for_ready(true);
    attempt->context.set_deadline(std::chrono::system_clock::time_point(clock_.System() + within));
    const grpc::Slice slice(call.request);
    attempt->reader =
        drone.stub->PrepareUnaryCall(&attempt->context, "/uncrew.v1.AvatarService/" + call.method,
                                     grpc::ByteBuffer(&slice, 1), &queue_->calls);
    shared_.sent.fetch_add(1);
    if (attempt->leaving.tries > 1) shared_.again.fetch_add(1);
    Attempt* const tag = attempt.get();
    drone.away.emplace(tag, std::move(attempt));
    tag->reader->StartCall();
    tag->reader->Finish(&tag->answer, &tag->status, tag);
  }
}

void DroneGroup::Done(Attempt& attempt, SteadyTime now) {
  Drone& drone = attempt.drone;
  const auto ended = drone.away.extract(&attempt);
  const AvatarCall& call = attempt.leaving.call;
  if (attempt.status.ok()) shared_.answered.fetch_add(1);
  if (!attempt.status.ok() || attempt.lost) {
    if (!attempt.lost) {
      shared_.first_error.Keep(fmt::format("{}: {}", call.method, attempt.status.error_message()));
    }
    drone.outbox.Lost(call.line, now);
    return;
  }
  drone.outbox.Answered(call.line);
  if (call.number == 0) return;
  drone.script.account().Answered(call, attempt.answer, attempt.leaving.tries, NowUs());
  (call.live ? latencies_.live : latencies_.durable).Record(now - attempt.leaving.due);
}

void DroneGroup::CutLink(Drone& drone) {
  for (const auto& [tag, attempt] : drone.away) {
    attempt->lost = true;
    attempt->context.TryCancel();
  }
  drone.stub.reset();
}

bool DroneGroup::AllAnswered() const {
  return std::ranges::all_of(drones_, [](const auto& drone) { return drone->outbox.empty(); });
}

void DroneGroup::ForEach(const std::function<void(const DroneScript&)>& each) const {
  for (const auto& drone : drones_) each(drone->script);
}

}  // namespace uplink::synthetic
