#include <vector>

#include "tests/bench/fair/bad_payloads.h"
#include "tests/bench/fair/misbehaviour.h"

namespace uplink::bench {
namespace {

/// Rejects of its session that the robot never confirms.
constexpr std::uint64_t kUnconfirmedRejects = 4000;
/// With fewer Rejects it goes on after this.
constexpr milliseconds kCollectMax{15'000};
/// Messages of a frame (limits.batch_uplinks_max).
constexpr std::size_t kFrameMessages = 250;
constexpr std::size_t kUnsentMax = std::size_t{256} * 1024;
/// After Welcome, for the first Reject.
constexpr milliseconds kFirstRejectWait{200};
/// Longer than a server may let a Hello wait.
constexpr milliseconds kWelcomeWait{12'000};
/// One stream of so many has a connection of its own, with its handshake.
constexpr std::size_t kStreamsAConnection = 4;

class RejectStorm final : public Misbehaviour {
 public:
  explicit RejectStorm(BadWorld& world) : world_(world), session_(NewBadSession()) {}

  void Act() override;
  [[nodiscard]] bool at_work() const override { return stage_ == Stage::kStorming; }

 private:
  enum class Stage : std::uint8_t { kCollecting, kStorming };

  void Collect(SteadyTime now);
  void Storm(SteadyTime now);
  void OpenNext();

  BadWorld& world_;
  BadSession session_;
  Stage stage_ = Stage::kCollecting;
  std::unique_ptr<BadStream> stream_;
  std::size_t sent_ = 0;
  std::size_t opened_ = 0;
  bool cancelled_ = false;
  SteadyTime began_{};
};

void RejectStorm::Act() {
  const SteadyTime now = world_.clock.Steady();
  if (began_ == SteadyTime()) began_ = now;
  if (stage_ == Stage::kCollecting) {
    Collect(now);
  } else {
    Storm(now);
  }
}

void RejectStorm::Collect(SteadyTime now) {
  if (session_.settled_seq >= kUnconfirmedRejects || now - began_ > kCollectMax) {
    stage_ = Stage::kStorming;
    if (stream_ != nullptr) stream_->Cut();
    return;
  }
  if (stream_ == nullptr || stream_->state() == BadStream::State::kOver) {
    stream_ = std::make_unique<BadStream>(world_, session_, BadStream::Confirms::kNothing);
  }
  if (stream_->state() != BadStream::State::kOpen) return;
  while (sent_ < kUnconfirmedRejects && stream_->unsent() < kUnsentMax) {
    std::vector<BadMessage> frame;
    for (std::size_t i = 0; i < kFrameMessages; ++i) frame.push_back({Malformed(sent_ + i)});
    stream_->Send(frame);
    sent_ += kFrameMessages;
  }
}

void RejectStorm::Storm(SteadyTime now) {
  if (stream_ == nullptr || stream_->state() == BadStream::State::kOver) return OpenNext();
  const bool open = stream_->state() == BadStream::State::kOpen;
  const bool late = now - stream_->since() > (open ? kFirstRejectWait : kWelcomeWait);
  // Every other one is left before the server can have said much.
  const bool enough = open && (opened_ % 2 == 1 || stream_->rejects() > 0);
  if (!late && !enough) return;
  if (opened_ % kStreamsAConnection == 0 || (late && cancelled_)) {
    stream_->Cut();
  } else if (!cancelled_) {
    cancelled_ = true;
    stream_->Cancel();
  }
}

void RejectStorm::OpenNext() {
  ++opened_;
  cancelled_ = false;
  if (stream_ != nullptr && stream_->reusable()) {
    stream_->OpenAgain();
  } else {
    stream_ = std::make_unique<BadStream>(world_, session_, BadStream::Confirms::kNothing);
  }
}

}  // namespace

std::unique_ptr<Misbehaviour> MakeRejectStorm(BadWorld& world, const std::string& /*ruri*/) {
  return std::make_unique<RejectStorm>(world);
}

}  // namespace uplink::bench
