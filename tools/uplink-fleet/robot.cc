#include "tools/uplink-fleet/robot.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/core.h>

namespace uplink::synthetic {
namespace {

constexpr milliseconds kBackoffFirst{100};
constexpr milliseconds kBackoffMax{2000};
/// A stream that got no Welcome within this is broken off.
constexpr std::chrono::seconds kWelcomeDeadline{10};
constexpr int kReceiveBytesMax = 4 * 1024 * 1024;

std::shared_ptr<grpc::Channel> NewChannel(const RobotOptions& options) {
  grpc::SslCredentialsOptions tls;
  tls.pem_root_certs = options.ca_pem;
  tls.pem_private_key = options.credentials.key_pem;
  tls.pem_cert_chain = options.credentials.certificate_pem;
  grpc::ChannelArguments arguments;
  // A TLS connection of its own for each robot.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  arguments.SetInt(GRPC_ARG_MAX_RECEIVE_MESSAGE_LENGTH, kReceiveBytesMax);
  arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  arguments.SetInt(GRPC_ARG_ENABLE_RETRIES, 0);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, 30'000);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 1000);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 1000);
  return grpc::CreateCustomChannel(options.target, grpc::SslCredentials(tls), arguments);
}

/// Ends that the protocol page makes the agent's own fault, or the operator's.
bool IsFault(grpc::StatusCode code) {
  return code == grpc::StatusCode::INVALID_ARGUMENT || code == grpc::StatusCode::UNAUTHENTICATED ||
         code == grpc::StatusCode::PERMISSION_DENIED ||
         code == grpc::StatusCode::RESOURCE_EXHAUSTED || code == grpc::StatusCode::UNIMPLEMENTED;
}

}  // namespace

template <void (Robot::*Handler)(bool)>
class Robot::Handled final : public Tag {
 public:
  explicit Handled(Robot& robot) : robot_(robot) {}
  void Proceed(bool ok) override { (robot_.*Handler)(ok); }

 private:
  Robot& robot_;
};

/// One stream; lives from Open until its Finish has returned.
struct Robot::Call {
  grpc::ClientContext context;
  std::unique_ptr<grpc::ClientAsyncReaderWriter<v1::RelayRequest, v1::RelayResponse>> stream;
  v1::RelayResponse incoming;
  grpc::Status status;
  bool writing = false;
  bool half_closing = false;
  bool half_closed = false;
  /// The read side returned its last tag.
  bool read_over = false;
  bool finishing = false;
  bool broken_by_us = false;
};

Robot::Robot(RobotOptions options, Agent agent, grpc::CompletionQueue& queue, const Clock& clock,
             Shared& shared)
    : options_(std::move(options)),
      agent_(std::move(agent)),
      queue_(queue),
      clock_(clock),
      shared_(shared),
      random_(options_.seed),
      tick_tag_(std::make_unique<Handled<&Robot::OnTick>>(*this)),
      started_tag_(std::make_unique<Handled<&Robot::OnStarted>>(*this)),
      read_tag_(std::make_unique<Handled<&Robot::OnRead>>(*this)),
      written_tag_(std::make_unique<Handled<&Robot::OnWritten>>(*this)),
      half_closed_tag_(std::make_unique<Handled<&Robot::OnHalfClosed>>(*this)),
      finished_tag_(std::make_unique<Handled<&Robot::OnFinished>>(*this)) {}

Robot::~Robot() = default;

void Robot::Start(milliseconds after) {
  next_tick_ = clock_.Steady() + after;
  ArmTick();
}

void Robot::ArmTick() {
  const auto wait = std::max(next_tick_ - clock_.Steady(), SteadyTime::duration::zero());
  alarm_.Set(&queue_, std::chrono::system_clock::time_point(clock_.System()) + wait,
             tick_tag_.get());
}

void Robot::OnTick(bool ok) {
  const SteadyTime now = clock_.Steady();
  const bool abandon = !ok || shared_.abandon.load(std::memory_order_acquire);
  if (state_ == State::kIdle && (abandon || agent_.ended_ok())) {
    done_ = true;
    shared_.closed_robots.fetch_add(1);
    return;
  }
  if (abandon) {
    call_->context.TryCancel();
  } else {
    agent_.Tick(now, clock_.System());
    if (state_ == State::kIdle && now >= next_open_) Open();
    if ((state_ == State::kOpening || state_ == State::kStreaming) && !agent_.welcomed() &&
        now - opened_ > kWelcomeDeadline) {
      shared_.KeepFirstError(fmt::format("{}: no Welcome within 10 s", options_.ruri));
      call_->context.TryCancel();
    }
    Break();
    Pump();
  }
  // A late tick does not make the next ones come in a burst.
  next_tick_ = std::max(next_tick_ + options_.tick, now);
  ArmTick();
}

void Robot::Break() {
  if (options_.breaks_per_minute <= 0 || state_ != State::kStreaming ||
      shared_.stage.load(std::memory_order_relaxed) != Stage::kRun || !agent_.welcomed()) {
    return;
  }
  const double ticks_a_minute = 60'000.0 / static_cast<double>(options_.tick.count());
  if (std::uniform_real_distribution<double>(0, 1)(random_) >=
      options_.breaks_per_minute / ticks_a_minute) {
    return;
  }
  shared_.breaks.fetch_add(1, std::memory_order_relaxed);
  call_->broken_by_us = true;
  // A network loses what was written last; the agent cannot tell, and must send it again.
  static_cast<void>(agent_.NextFrame(clock_.Steady(), clock_.System()));
  call_->context.TryCancel();
  // Half of the breaks cost the connection too.
  if (random_() % 2 == 0) ForgetChannel();
}

void Robot::ForgetChannel() { stub_.reset(); }

void Robot::Open() {
  if (stub_ == nullptr) stub_ = v1::UplinkRelay::NewStub(NewChannel(options_));
  call_ = std::make_unique<Call>();
  call_->stream = stub_->PrepareAsyncRelay(&call_->context, &queue_);
  state_ = State::kOpening;
  opened_ = clock_.Steady();
  call_->stream->StartCall(started_tag_.get());
}

void Robot::OnStarted(bool ok) {
  if (!ok) {
    call_->read_over = true;
    EndIfQuiet();
    return;
  }
  state_ = State::kStreaming;
  shared_.streams.fetch_add(1, std::memory_order_relaxed);
  call_->stream->Read(&call_->incoming, read_tag_.get());
  Write(agent_.BeginStream());
}

void Robot::Write(const v1::RelayRequest& frame) {
  call_->writing = true;
  call_->stream->Write(frame, written_tag_.get());
}

void Robot::Pump() {
  if (state_ != State::kStreaming || call_->writing || call_->half_closed || call_->read_over ||
      call_->broken_by_us) {
    return;
  }
  if (auto frame = agent_.NextFrame(clock_.Steady(), clock_.System())) {
    Write(*frame);
  } else if (agent_.may_close()) {
    call_->half_closing = true;
    call_->half_closed = true;
    call_->stream->WritesDone(half_closed_tag_.get());
  }
}

void Robot::OnWritten(bool ok) {
  call_->writing = false;
  // A write that failed means that the stream is over: the read side will say so too.
  if (ok) Pump();
  EndIfQuiet();
}

void Robot::OnHalfClosed(bool /*ok*/) {
  call_->half_closing = false;
  EndIfQuiet();
}

void Robot::OnRead(bool ok) {
  if (!ok) {
    call_->read_over = true;
    EndIfQuiet();
    return;
  }
  const absl::Status status = agent_.OnFrame(call_->incoming, clock_.Steady());
  if (!status.ok()) {
    shared_.KeepFirstBrokenRule(
        fmt::format("{}: {}", options_.ruri, std::string(status.message())));
    call_->context.TryCancel();
  }
  call_->stream->Read(&call_->incoming, read_tag_.get());
  Pump();
}

void Robot::EndIfQuiet() {
  if (!call_->read_over || call_->writing || call_->half_closing || call_->finishing) return;
  call_->finishing = true;
  if (state_ == State::kStreaming) shared_.streams.fetch_sub(1, std::memory_order_relaxed);
  state_ = State::kEnding;
  call_->stream->Finish(&call_->status, finished_tag_.get());
}

void Robot::OnFinished(bool /*ok*/) {
  const grpc::Status& status = call_->status;
  const auto code = static_cast<std::size_t>(status.error_code());
  if (!call_->broken_by_us && code < kStatusCodes) {
    shared_.ends[code].fetch_add(1, std::memory_order_relaxed);
  }
  failures_ = agent_.welcomed() ? 0 : failures_ + 1;
  if (status.ok() && call_->half_closed) {
    agent_.OnEndedOk();
  } else if (IsFault(status.error_code())) {
    shared_.KeepFirstBrokenRule(
        fmt::format("{}: code {}: {}", options_.ruri, code, status.error_message()));
  } else if (!call_->broken_by_us && !status.ok()) {
    shared_.KeepFirstError(
        fmt::format("{}: code {}: {}", options_.ruri, code, status.error_message()));
  }
  const bool at_once = call_->broken_by_us;
  agent_.EndStream();
  call_.reset();
  state_ = State::kIdle;
  if (at_once && !shared_.abandon.load(std::memory_order_acquire)) {
    // While commits of the broken stream still wait: the hardest moment to resume at.
    Open();
  } else {
    next_open_ = clock_.Steady() + NextBackoff();
  }
}

milliseconds Robot::NextBackoff() {
  const int doublings = std::min(failures_, 5);
  const auto most = std::min(kBackoffFirst * (1 << doublings), kBackoffMax);
  return milliseconds(
      most.count() / 2 +
      static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(most.count() / 2 + 1)));
}

}  // namespace uplink::synthetic
