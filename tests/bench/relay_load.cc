#include "tests/bench/relay_load.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <random>
#include <thread>

#include <grpcpp/grpcpp.h>

#include "schema/base/check.h"
#include "schema/base/clock.h"
#include "schema/encode.h"
#include "tests/support/test_agent.h"
#include "uplink/v1/relay.grpc.pb.h"

namespace uplink::bench {
namespace {

constexpr std::int64_t kTimeMs = 1'763'683'200'000;

std::string MessagePayload(std::size_t text_bytes) {
  model::Message message;
  message.unix_time_ms = kTimeMs;
  message.message = std::string(text_bytes, 'm');
  return schema::Encode(message);
}

std::string FaultPayload(std::uint64_t number) {
  model::Fault fault;
  fault.unix_time_ms = kTimeMs;
  fault.fault_id = "BENCH";
  fault.source = "bench";
  fault.active = number % 2 == 0;
  return schema::Encode(fault);
}

model::SessionId NewSession() {
  std::random_device random;
  std::array<std::uint8_t, model::SessionId::kBytes> bytes{};
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return model::SessionId(bytes);
}

testing::ChannelSpec SpecOf(const RelayShape& shape, std::size_t robot) {
  testing::ChannelSpec spec;
  spec.port = shape.port;
  spec.server_ca = shape.server_ca;
  spec.identity = shape.identities[robot];
  return spec;
}

}  // namespace

class RelayLoad::Stream final {
 public:
  Stream(const RelayShape& shape, std::size_t robot)
      : shape_(shape),
        payload_(MessagePayload(shape.text_bytes)),
        stub_(v1::UplinkRelay::NewStub(testing::MakeChannel(SpecOf(shape, robot)))),
        stream_(stub_->Relay(&context_)) {
    v1::RelayResponse frame;
    const bool greeted = stream_->Write(testing::HelloFrame(NewSession())) && stream_->Read(&frame);
    UPLINK_CHECK(greeted && frame.has_welcome(), "the server welcomes a robot");
    ahead_max_ =
        std::min<std::uint64_t>(shape.ahead, frame.welcome().limits().in_flight_uplinks_max());
    reader_ = std::jthread([this] { Read(); });
    writer_ = std::jthread([this] { Write(); });
  }
  ~Stream() {
    {
      const std::lock_guard lock(mutex_);
      over_ = true;
    }
    moved_.notify_all();
    context_.TryCancel();
    writer_.join();
    reader_.join();
    static_cast<void>(stream_->Finish());
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  [[nodiscard]] std::uint64_t acked() const { return acked_.load(); }

 private:
  void Write() {
    v1::RelayRequest frame;
    std::uint64_t sent = 0;
    grpc::WriteOptions more;
    more.set_buffer_hint();
    while (WaitForRoom(sent + shape_.frame_messages)) {
      v1::UplinkBatch& batch = *frame.mutable_batch();
      batch.clear_uplinks();
      for (std::size_t i = 0; i < shape_.frame_messages; ++i) {
        v1::Uplink& uplink = *batch.add_uplinks();
        uplink.set_seq(++sent);
        uplink.set_rover_nexus(payload_);
      }
      // Small frames share a TLS record, unless the robot is about to wait.
      const bool last = sent + shape_.frame_messages > acked_.load() + ahead_max_;
      const bool hint = !last && (sent / shape_.frame_messages) % kFramesARecord != 0;
      if (!stream_->Write(frame, hint ? more : grpc::WriteOptions())) return;
    }
  }
  bool WaitForRoom(std::uint64_t through) {
    std::unique_lock lock(mutex_);
    moved_.wait(lock, [&] { return over_ || through <= acked_.load() + ahead_max_; });
    return !over_;
  }
  void Read() {
    v1::RelayResponse frame;
    while (stream_->Read(&frame)) {
      UPLINK_CHECK(!frame.has_reject(), "what the bench sends is good");
      if (!frame.has_ack()) continue;
      {
        const std::lock_guard lock(mutex_);
        acked_.store(frame.ack().through_seq());
      }
      moved_.notify_one();
    }
    const std::lock_guard lock(mutex_);
    over_ = true;
    moved_.notify_all();
  }

  static constexpr std::uint64_t kFramesARecord = 16;

  const RelayShape& shape_;
  const std::string payload_;
  grpc::ClientContext context_;
  std::unique_ptr<v1::UplinkRelay::Stub> stub_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::RelayRequest, v1::RelayResponse>> stream_;
  std::uint64_t ahead_max_ = 0;
  std::atomic<std::uint64_t> acked_{0};
  std::mutex mutex_;
  std::condition_variable moved_;
  bool over_ = false;
  std::jthread reader_;
  std::jthread writer_;
};

RelayLoad::RelayLoad(const RelayShape& shape) {
  for (std::size_t robot = 0; robot < shape.identities.size(); ++robot) {
    streams_.push_back(std::make_unique<Stream>(shape, robot));
  }
}

RelayLoad::~RelayLoad() = default;

std::uint64_t RelayLoad::acked() const {
  std::uint64_t sum = 0;
  for (const auto& stream : streams_) sum += stream->acked();
  return sum;
}

std::vector<double> MeasureAcks(const RelayShape& shape, std::size_t count) {
  const SystemClock clock;
  testing::TestAgent::Options options;
  options.patience = std::chrono::minutes(10);
  testing::TestAgent agent(testing::MakeChannel(SpecOf(shape, 0)), options);
  UPLINK_CHECK(agent.Connect(NewSession()).has_value(), "the server welcomes a robot");
  std::vector<double> took;
  took.reserve(count);
  for (model::Seq seq = 1; seq <= count; ++seq) {
    const SteadyTime began = clock.Steady();
    const bool acked =
        agent.Send(testing::BatchFrame({{seq, FaultPayload(seq)}})) && agent.ReadThrough(seq);
    UPLINK_CHECK(acked, "a fault is acked");
    took.push_back(std::chrono::duration<double, std::milli>(clock.Steady() - began).count());
  }
  std::ranges::sort(took);
  return took;
}

}  // namespace uplink::bench
