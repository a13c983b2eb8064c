// Any sequence of frames, breaks, timers and failures of the store: sessions never crash, every
// count adds up, Acks only grow, a Reject comes before the Ack that covers it, and in the end
// nothing that was taken waits.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "schema/base/check.h"
#include "tests/fuzz/frame_order.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/session_steps.h"
#include "tests/unit/server/session/session_bench.h"

namespace uplink::fuzz {
namespace {

/// Streams of one process; more would only cost time.
constexpr std::size_t kStreamsMax = 64;
constexpr std::uint8_t kOtherProcess = 255;

session::BenchLimits SmallLimits() {
  session::BenchLimits limits;
  limits.session.in_flight_uplinks_max = 6;
  limits.session.batch_uplinks_max = 16;
  limits.journal.bytes_max = 6'000;
  limits.journal.batch_records_max = 4;
  limits.robots_max = 3;
  return limits;
}

std::string RuriOf(std::uint8_t robot) { return "rcan://fuzz/" + std::to_string(robot % 4); }

const std::string& ContentOf(std::uint8_t which) {
  static const std::array<std::string, 5> contents{
      session::Fault(), session::BadFault(), session::RefusedFault(), session::Motion(), "garbage"};
  return contents[which % contents.size()];
}

/// A stream under watch.
struct Watched {
  session::BenchStream* stream = nullptr;
  model::Seq last_seq = 0;
  std::size_t checked = 0;
  FrameOrder order;

  void Check() {
    const auto& frames = stream->frames();
    for (; checked < frames.size(); ++checked) order.Add(frames[checked]);
  }
};

class World final {
 public:
  World() { Restart(); }

  void Do(Step step, Input& input);
  void Check();
  void End();

 private:
  void Restart();
  void Open(std::uint8_t robot);
  void Send(std::string_view bytes);
  void Hello(Input& input);
  void Batch(Input& input);
  void Taken(std::uint8_t robot);
  [[nodiscard]] bool Reads() const {
    const session::BenchStream* const stream = streams_[picked_].stream;
    return stream->reading() && stream->end().empty();
  }

  testing::ManualClock clock_;
  testing::FakeDatabase database_;
  testing::FakeStore elsewhere_{database_, storage::ProcessId{kOtherProcess}};
  std::unique_ptr<session::BenchServer> server_;
  std::vector<Watched> streams_;
  /// Of every Hello that was sent.
  std::set<std::string> sessions_;
  std::size_t picked_ = 0;
  std::uint8_t processes_ = 0;
};

void World::Restart() {
  processes_ = static_cast<std::uint8_t>(processes_ % (kOtherProcess - 1) + 1);
  server_.reset();
  server_ = std::make_unique<session::BenchServer>(clock_, database_, processes_, SmallLimits());
  streams_.clear();
  Open(0);
}

void World::Open(std::uint8_t robot) {
  if (streams_.size() >= kStreamsMax) return;
  streams_.push_back({.stream = &server_->Open(RuriOf(robot))});
  picked_ = streams_.size() - 1;
}

void World::Send(std::string_view bytes) {
  if (!Reads()) return;
  v1::RelayRequest frame;
  if (frame.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())) && frame.has_hello()) {
    sessions_.insert(frame.hello().session_id());
  }
  streams_[picked_].stream->SendBytes(bytes);
}

void World::Hello(Input& input) {
  const std::uint8_t session = input.Byte();
  const model::Seq settled = input.Byte();
  const model::Seq judged = settled + input.Byte();
  Send(session::HelloFrame(session::SessionOf(session), settled, judged).SerializeAsString());
}

void World::Batch(Input& input) {
  v1::RelayRequest frame = session::BatchFrame({});
  model::Seq seq = streams_[picked_].last_seq;
  for (int left = input.Byte() % 18; left > 0; --left) {
    const std::uint8_t above = input.Byte();
    // The highest bytes are steps too large to be counted one by one.
    seq += above < 240 ? above : model::Seq{1} << (above - 240) * 4U;
    v1::Uplink& uplink = *frame.mutable_batch()->add_uplinks();
    uplink.set_seq(seq);
    const std::uint8_t content = input.Byte();
    if (content % 8 < 5) uplink.set_rover_nexus(ContentOf(content % 8));
    if (content % 8 == 5) uplink.set_rcan_robot_state("state");
  }
  if (!Reads()) return;
  streams_[picked_].last_seq = seq;
  Send(frame.SerializeAsString());
}

void World::Taken(std::uint8_t robot) {
  const auto id = std::make_shared<const model::RobotId>(
      model::RobotId{.ruri = RuriOf(robot), .fleet = "elsewhere"});
  const std::vector<storage::OpenRequest> requests{{.robot = id, .at = clock_.System()}};
  UPLINK_CHECK(elsewhere_.OpenStreams(requests).ok(), "the other process's store is here");
}

void World::Do(Step step, Input& input) {
  session::BenchStream& stream = *streams_[picked_].stream;
  switch (step) {
    case Step::kStream:
      return Open(input.Byte());
    case Step::kPick:
      picked_ = input.Byte() % streams_.size();
      return;
    case Step::kFrame: {
      const std::size_t low = input.Byte();
      return Send(input.Bytes(low + (std::size_t{input.Byte()} << 8U)));
    }
    case Step::kHello:
      return Hello(input);
    case Step::kBatch:
      return Batch(input);
    case Step::kBreak:
      return stream.Break();
    case Step::kHalfClose:
      if (Reads()) stream.HalfClose();
      return;
    case Step::kTooLarge:
      if (Reads()) stream.SendTooLarge(1 << 21);
      return;
    case Step::kDrain:
      return stream.Drain(milliseconds(100) * input.Byte());
    case Step::kStopReading:
      return stream.StopReading();
    case Step::kReadOne:
      return stream.ReadOne();
    case Step::kReadAgain:
      return stream.ReadAgain();
    case Step::kJournal:
      static_cast<void>(server_->Advance());
      return;
    case Step::kWakes:
      return server_->DeliverWakes();
    case Step::kCommit:
      return server_->Commit();
    case Step::kTime:
      return server_->Pass(milliseconds(50) * input.Byte());
    case Step::kStoreFails:
      return server_->store().FailNext(
          1, input.Byte() % 2 == 0 ? testing::FailAt::kBefore : testing::FailAt::kAfter);
    case Step::kStoreAway:
      return server_->StoreAway();
    case Step::kStoreBack:
      return server_->StoreBack();
    case Step::kTaken:
      return Taken(input.Byte());
    case Step::kRestart:
      return Restart();
  }
}

void World::Check() {
  const metrics::MessageCounts counts = server_->counts();
  UPLINK_CHECK(counts.Balanced(), "the conservation law");
  UPLINK_CHECK(counts.in_flight >= 0, "nothing is settled that was not taken");
  for (Watched& watched : streams_) watched.Check();
}

void World::End() {
  for (const Watched& watched : streams_) watched.stream->Break();
  server_->StoreBack();
  server_->Commit();
  Check();
  UPLINK_CHECK(server_->journal().idle(), "everything commits");
  UPLINK_CHECK(server_->counts().in_flight == 0, "what was taken is settled");
  // A session that the store evicted may begin again under its id.
  if (sessions_.size() > storage::kSessionsPerRobotMax) return;
  for (const auto& [ruri, session] : database_.Sessions()) {
    const auto& written = database_.Log(ruri, session).times_written;
    UPLINK_CHECK(std::ranges::all_of(written, [](const auto& each) { return each.second == 1; }),
                 "nothing is written twice");
  }
}

}  // namespace
}  // namespace uplink::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  uplink::fuzz::Input input(data, size);
  uplink::fuzz::World world;
  while (input.more()) {
    world.Do(static_cast<uplink::fuzz::Step>(input.Byte() % uplink::fuzz::kSteps), input);
    world.Check();
  }
  world.End();
  return 0;
}
