#include "tools/uplink-fleet/robot/robot.h"

#include <chrono>
#include <utility>

#include <fmt/core.h>

namespace uplink::synthetic {
namespace {

constexpr const char* kMethod = "/uplink.v1.UplinkRelay/Relay";
/// A stream that got no Welcome within this is broken off.
constexpr std::chrono::seconds kWelcomeDeadline{10};
/// A robot that this program could not drive for longer leaves the ticks before out.
constexpr std::chrono::seconds kCatchUpMax{10};
/// How long the network holds a connection open that nothing passes.
constexpr std::chrono::seconds kFrozenFor{60};
/// Unsent bytes above which no more frames are made.
constexpr std::size_t kUnsentMax = 64 * 1024;
/// Tells the network's chance from that of a robot's waits, with the same seed.
constexpr std::uint64_t kBackoffSeed = 0x9E37'79B9'7F4A'7C15;

/// Ends for which the protocol page blames the agent, or the operator.
bool IsFault(int code) {
  return code == link::kCodeInvalidArgument || code == link::kCodeUnauthenticated ||
         code == link::kCodePermissionDenied || code == link::kCodeResourceExhausted ||
         code == link::kCodeUnimplemented;
}

}  // namespace

Robot::Robot(RobotOptions options, Agent agent, const Scenario& scenario, SteadyTime start,
             link::Loop& loop, const Clock& clock, Shared& shared)
    : options_(std::move(options)),
      agent_(std::move(agent)),
      scenario_(scenario),
      start_(start),
      loop_(loop),
      clock_(clock),
      shared_(shared),
      network_(options_.seed, start),
      backoff_(options_.seed ^ kBackoffSeed),
      arrival_(options_.joins_at),
      timer_(loop.io),
      phase_(&scenario.phases.front()) {}

Robot::~Robot() = default;

void Robot::Start(milliseconds after) {
  next_tick_ = start_ + after;
  ArmTick();
}

void Robot::ArmTick() {
  timer_.expires_at(next_tick_);
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) OnTick();
  });
}

void Robot::OnTick() {
  const SteadyTime now = clock_.Steady();
  const bool abandon = shared_.abandon.load(std::memory_order_acquire);
  if (abandon || (state_ == State::kIdle && agent_.ended_ok())) return Done();
  if (const auto look = arrival_.Awaited(now, shared_.stage.load(std::memory_order_relaxed))) {
    next_tick_ = *look;
    return ArmTick();
  }
  LiveUpTo(now);
  leftovers_.DropOver(now);
  if (state_ == State::kIdle && now >= next_open_) {
    Connect();
  } else if (state_ != State::kIdle && !agent_.welcomed() && now - opened_ > kWelcomeDeadline) {
    shared_.first_error.Keep(fmt::format("{}: no Welcome within 10 s", options_.ruri));
    DropConnection();
    backoff_.Failed();
    StreamIsOver();
  }
  const Mishap mishap = network_.Take(*phase_, now);
  if (state_ == State::kStreaming && agent_.welcomed() &&
      shared_.stage.load(std::memory_order_relaxed) == Stage::kRun) {
    Suffer(mishap, now);
  }
  ReadSlowly(now);
  Pump();
  ArmTick();
}

void Robot::LiveUpTo(SteadyTime now) {
  if (now - next_tick_ > kCatchUpMax) {
    const auto skipped = (now - next_tick_) / phase_->tick();
    shared_.skipped_ticks.fetch_add(static_cast<std::uint64_t>(skipped));
    for (auto i = skipped; i > 0; --i) network_.Skip(*phase_);
    next_tick_ = now;
  }
  // A late tick was due at its own time: what waited for this program counts as waiting.
  do {
    Enter(scenario_.At(std::chrono::duration_cast<milliseconds>(next_tick_ - start_)));
    agent_.Tick(next_tick_, clock_.System());
    network_.Draw(*phase_);
    next_tick_ += phase_->tick();
  } while (next_tick_ <= now);
}

void Robot::Enter(const Phase& phase) {
  if (&phase == phase_) return;
  phase_ = &phase;
  network_.Enter(phase, next_tick_);
  agent_.Adopt(phase);
  if (connection_ != nullptr) connection_->SetDelay(phase.trouble.delay);
}

void Robot::Suffer(Mishap mishap, SteadyTime now) {
  switch (mishap) {
    case Mishap::kNone:
      return;
    case Mishap::kCut:
      shared_.breaks.fetch_add(1, std::memory_order_relaxed);
      return Cut();
    case Mishap::kBreak:
      return Break();
    case Mishap::kHalfOpen:
      shared_.breaks.fetch_add(1, std::memory_order_relaxed);
      if (!own_connection()) return Cut();
      return LeaveBehind(true, now);
    case Mishap::kTakeover:
      shared_.takeovers.fetch_add(1, std::memory_order_relaxed);
      return LeaveBehind(false, now);
  }
}

void Robot::ReadSlowly(SteadyTime now) {
  if (connection_ == nullptr) return;
  const bool slow = ReadsSlowly(phase_->trouble, options_.index);
  const bool running = shared_.stage.load(std::memory_order_relaxed) == Stage::kRun;
  connection_->PauseReading(slow && running && agent_.welcomed() &&
                            (now - start_) % kSlowCycle < kSlowPause);
}

void Robot::Break() {
  shared_.breaks.fetch_add(1, std::memory_order_relaxed);
  static_cast<void>(LastFrame());
  broken_by_us_ = true;
  if (++breaks_ % 2 == 0) {
    connection_->CancelStream();
    return;
  }
  // Half of the breaks cost the connection too.
  if (options_.leads) connection_->Cut();
  connection_.reset();
  StreamIsOver();
}

std::string Robot::LastFrame() {
  const auto frame = agent_.NextFrame(clock_.Steady(), clock_.System());
  return frame ? frame->SerializeAsString() : std::string();
}

void Robot::Cut() {
  static_cast<void>(LastFrame());
  DropConnection();
  broken_by_us_ = true;
  StreamIsOver();
}

void Robot::DropConnection() {
  if (own_connection()) connection_->Cut();
  connection_.reset();
}

void Robot::LeaveBehind(bool frozen, SteadyTime now) {
  leftovers_.MakeRoom();
  auto leftover =
      std::make_unique<Leftover>(std::exchange(connection_, nullptr), now + kFrozenFor, shared_);
  const std::string frame = LastFrame();
  if (frozen) {
    leftover->Freeze();
  } else if (!frame.empty()) {
    leftover->Send(frame);
  }
  leftovers_.Add(std::move(leftover));
  broken_by_us_ = true;
  StreamIsOver();
}

void Robot::Connect() {
  state_ = State::kConnecting;
  opened_ = clock_.Steady();
  if (connection_ != nullptr && connection_->usable()) return OpenStream();
  auto& events = static_cast<link::StreamEvents&>(*this);
  const milliseconds delay = phase_->trouble.delay;
  if (options_.dial) {
    connection_ = options_.dial(loop_, options_.dialled, events);
  } else if (Gateway* const gateway = options_.gateway) {
    connection_ =
        std::make_unique<link::GrpcConnection>(gateway->Link(delay), gateway->authority(), events);
  } else {
    options_.link.delay = delay;
    connection_ = std::make_unique<link::GrpcConnection>(loop_, options_.link, events);
  }
  connection_->Connect();
}

void Robot::OnConnected() {
  if (options_.gateway == nullptr) shared_.connects.fetch_add(1, std::memory_order_relaxed);
  OpenStream();
}

void Robot::OpenStream() {
  half_closed_ = false;
  if (!connection_->OpenStream(kMethod)) {
    connection_.reset();
    return StreamIsOver();
  }
  state_ = State::kStreaming;
  shared_.streams.fetch_add(1, std::memory_order_relaxed);
  v1::RelayRequest hello = agent_.BeginStream();
  if (options_.gateway != nullptr) hello.mutable_hello()->set_robot_ruri(options_.ruri);
  connection_->Send(hello.SerializeAsString());
}

void Robot::Pump() {
  if (state_ != State::kStreaming || half_closed_ || broken_by_us_) return;
  while (connection_->unsent() < kUnsentMax) {
    const SteadyTime now = clock_.Steady();
    agent_.Fill(now, clock_.System());
    const auto frame = agent_.NextFrame(now, clock_.System());
    if (!frame) break;
    connection_->Send(frame->SerializeAsString());
  }
  if (agent_.may_close()) {
    half_closed_ = true;
    if (options_.parked_for > milliseconds(0)) {
      const SystemTime back = clock_.System() + options_.parked_for;
      connection_->Send(agent_.SayGoodbye(UnixMs(back)).SerializeAsString());
    }
    connection_->HalfClose();
  }
}

void Robot::OnMessage(std::string_view message) {
  v1::RelayResponse frame;
  absl::Status status = absl::InternalError("the server broke a rule: a frame is protobuf");
  if (frame.ParseFromArray(message.data(), static_cast<int>(message.size()))) {
    status = agent_.OnFrame(frame, clock_.Steady());
  }
  if (!status.ok()) {
    shared_.CountBrokenRule(fmt::format("{}: {}", options_.ruri, std::string(status.message())));
    connection_->CancelStream();
    return;
  }
  Pump();
}

void Robot::OnEnded(const link::StreamEnd& end) {
  Note(end);
  if (!connection_->usable()) connection_.reset();
  StreamIsOver();
}

void Robot::Note(const link::StreamEnd& end) {
  if (!broken_by_us_) shared_.CountEnd(end.code);
  if (agent_.welcomed()) {
    backoff_.Succeeded();
  } else {
    backoff_.Failed();
  }
  if (end.code == link::kCodeOk && half_closed_) {
    agent_.OnEndedOk();
  } else if (IsFault(end.code)) {
    shared_.CountBrokenRule(fmt::format("{}: code {}: {}", options_.ruri, end.code, end.message));
  } else if (!broken_by_us_ && end.code != link::kCodeOk) {
    shared_.first_error.Keep(fmt::format("{}: code {}: {}", options_.ruri, end.code, end.message));
  }
}

void Robot::StreamIsOver() {
  if (state_ == State::kStreaming) shared_.streams.fetch_sub(1, std::memory_order_relaxed);
  state_ = State::kIdle;
  agent_.EndStream();
  const bool at_once = std::exchange(broken_by_us_, false);
  if (at_once && !shared_.abandon.load(std::memory_order_acquire)) {
    // While commits of the broken stream still wait: the hardest moment to resume at.
    Connect();
  } else {
    next_open_ = clock_.Steady() + backoff_.Next();
  }
}

void Robot::Done() {
  if (state_ == State::kStreaming) shared_.streams.fetch_sub(1, std::memory_order_relaxed);
  state_ = State::kIdle;
  connection_.reset();
  leftovers_.Clear();
  shared_.closed_robots.fetch_add(1);
}

}  // namespace uplink::synthetic
