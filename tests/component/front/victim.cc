#include "tests/component/front/victim.h"

namespace uplink::testing {
namespace {

constexpr std::size_t kBatch = 4;
constexpr std::chrono::milliseconds kPause{2};
/// Longer than any test.
constexpr std::chrono::milliseconds kCallPatience{100'000};

}  // namespace

Victim::Victim(const RelayWorld& world, int number)
    : ruri_(RuriOf(number)),
      thread_([this, channel = world.Channel(RuriOf(number))] { Run(channel); }) {}

Victim::~Victim() { static_cast<void>(Finish()); }

void Victim::Run(const std::shared_ptr<grpc::Channel>& channel) {
  TestAgent agent(channel, {.patience = kCallPatience});
  if (!agent.Connect(session())) return;
  while (Pause()) {
    std::vector<Sent> batch;
    for (std::size_t i = 1; i <= kBatch; ++i) batch.push_back({acked_ + i, FaultPayload("f")});
    if (!agent.Send(BatchFrame(batch)) || !agent.ReadThrough(acked_ + kBatch)) return;
    acked_ += kBatch;
  }
  agent.HalfClose();
  well_ = agent.End().ok() && agent.rejects().empty();
}

bool Victim::Pause() {
  std::unique_lock lock(mutex_);
  return !changed_.wait_for(lock, kPause, [this] { return ends_; });
}

bool Victim::GoesOn() const {
  const model::Seq before = acked_;
  // One batch may have been on its way already.
  return Eventually([&] { return acked_ >= before + 2 * kBatch; });
}

bool Victim::Finish() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  return well_;
}

}  // namespace uplink::testing
