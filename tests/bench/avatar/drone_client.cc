#include "tests/bench/avatar/drone_client.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include <fmt/core.h>

#include "uncrew/v1/avatar.pb.h"

namespace uplink::bench {
namespace {

/// A flag and a length before each message of gRPC.
constexpr std::size_t kPrefixBytes = 5;
/// Between two samples of a drone.
constexpr std::int64_t kSampleUs = 1'000'000 / 23;
constexpr std::int64_t kUsPerMs = 1000;

std::string Framed(std::string_view message) {
  std::string framed(kPrefixBytes, '\0');
  for (std::size_t i = 1; i < kPrefixBytes; ++i) {
    framed[i] = static_cast<char>(message.size() >> (8 * (kPrefixBytes - 1 - i)));
  }
  return framed.append(message);
}

/// Whether the sample is kept or shown.
bool IsTaken(const ::uncrew::v1::PublishResponse& answer) {
  return answer.outcome() == ::uncrew::v1::OUTCOME_APPLIED ||
         answer.outcome() == ::uncrew::v1::OUTCOME_STORED;
}

}  // namespace

/// One call, and then the next one.
class DroneClient::Call final : public link::Http2Events {
 public:
  explicit Call(DroneClient& drone) : drone_(drone) {}

  /// False if the connection takes none.
  bool Begin(const AvatarSample& sample, const std::string& request) {
    sample_ = &sample;
    out_ = Framed(request);
    out_taken_ = 0;
    in_.clear();
    status_.clear();
    status_message_.clear();
    began_ = drone_.world_.clock.Steady();
    stream_ = drone_.link_->http2().Open({{":method", "POST"},
                                          {":scheme", "https"},
                                          {":path", sample.path},
                                          {":authority", drone_.authority_},
                                          {"content-type", "application/grpc"},
                                          {"te", "trailers"},
                                          {"grpc-timeout", "10S"}},
                                         *this);
    return stream_ > 0;
  }
  void Forget() {
    if (stream_ > 0) drone_.link_->http2().Forget(std::exchange(stream_, 0));
  }

  void Tell(CallTally& tally) const {
    const std::chrono::duration<double, std::milli> took = drone_.world_.clock.Steady() - began_;
    (sample_->durable ? tally.durable_ms : tally.live_ms).push_back(took.count());
    ::uncrew::v1::PublishResponse answer;
    const bool is_ok = status_ == "0" && in_.size() >= kPrefixBytes &&
                       answer.ParseFromArray(in_.data() + kPrefixBytes,
                                             static_cast<int>(in_.size() - kPrefixBytes));
    if (is_ok && IsTaken(answer)) return;
    ++(is_ok ? tally.not_taken : tally.failed);
    if (!tally.example.empty()) return;
    tally.example = is_ok
                        ? fmt::format("{}: {}", sample_->path, answer.ShortDebugString())
                        : fmt::format("{}: status {} {}", sample_->path, status_, status_message_);
  }

 private:
  void OnHeader(std::string_view name, std::string_view value) override {
    if (name == "grpc-status") status_ = value;
    if (name == "grpc-message") status_message_ = value;
  }
  void OnData(std::string_view bytes) override { in_.append(bytes); }
  void OnClosed(std::uint32_t error) override {
    stream_ = 0;
    if (status_.empty()) status_message_ = fmt::format("HTTP/2 error {}", error);
    drone_.Settle(*this);
  }
  std::size_t TakeBody(std::uint8_t* to, std::size_t max, bool& end) override {
    const std::size_t taken = std::min(max, out_.size() - out_taken_);
    std::memcpy(to, out_.data() + out_taken_, taken);
    out_taken_ += taken;
    end = out_taken_ == out_.size();
    return taken;
  }

  DroneClient& drone_;
  const AvatarSample* sample_ = nullptr;
  std::int32_t stream_ = 0;
  SteadyTime began_;
  std::string out_;
  std::size_t out_taken_ = 0;
  std::string in_;
  std::string status_;
  std::string status_message_;
};

DroneClient::DroneClient(DroneWorld& world, std::shared_ptr<link::Http2Link> link,
                         std::string authority, Who who)
    : world_(world),
      link_(std::move(link)),
      authority_(std::move(authority)),
      who_(std::move(who)),
      began_(world.clock.System()) {
  link_->Join(*this);
  link_->Connect();
}

DroneClient::~DroneClient() {
  link_->Leave(*this);
  for (const auto& call : calls_) call->Forget();
}

void DroneClient::Send(std::size_t messages) {
  for (std::size_t i = 0; i < messages; ++i) {
    if (free_.empty()) {
      calls_.push_back(std::make_unique<Call>(*this));
      free_.push_back(calls_.back().get());
    }
    Call& call = *free_.back();
    free_.pop_back();
    const AvatarSample& sample = world_.samples[(who_.number + sent_) % world_.samples.size()];
    ++sent_;
    if (!call.Begin(sample, RequestOf(sample, NextMetadata()))) {
      return Fail("the connection takes no more calls");
    }
    link_->Flush();
  }
}

AvatarMetadata DroneClient::NextMetadata() {
  const auto since_us = static_cast<std::int64_t>(sent_) * kSampleUs;
  return {.uav_id = who_.uav_id,
          .unix_us = UnixMs(began_) * kUsPerMs + since_us,
          .boot_us = static_cast<std::uint64_t>(since_us)};
}

void DroneClient::Settle(Call& call) {
  call.Tell(world_.tally);
  free_.push_back(&call);
  ++acked_;
}

}  // namespace uplink::bench
