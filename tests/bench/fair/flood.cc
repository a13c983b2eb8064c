#include <algorithm>
#include <deque>
#include <utility>

#include "tests/bench/fair/misbehaviour.h"

namespace uplink::bench {
namespace {

using std::chrono::duration;
using std::chrono::duration_cast;

/// Bytes that wait for the server at most.
constexpr std::size_t kUnsentMax = std::size_t{1024} * 1024;
/// Frames of one Act: signals and answers are looked at in between.
constexpr int kFramesAnAct = 16;
/// Between two tries after a stream ended.
constexpr milliseconds kRetry{50};
/// Longer than a server may let a Hello wait.
constexpr milliseconds kWelcomeWait{12'000};
/// Connections that are left as they are; the oldest is cut for the next.
constexpr std::size_t kLeftMax = 16;
/// What was not sent for longer is not made up for.
constexpr milliseconds kCatchUpMax{200};

class Flood final : public Misbehaviour {
 public:
  Flood(BadWorld& world, FloodStyle style)
      : world_(world), style_(std::move(style)), session_(NewBadSession()) {}

  void Act() override;
  [[nodiscard]] bool at_work() const override { return at_work_; }

 private:
  void Leave();
  void OpenIfOver(SteadyTime now);
  void SendWhatIsDue(SteadyTime now);

  BadWorld& world_;
  const FloodStyle style_;
  BadSession session_;
  std::unique_ptr<BadStream> stream_;
  /// Connections that were left as they are, the oldest first.
  std::deque<std::unique_ptr<BadStream>> left_;
  bool at_work_ = false;
  SteadyTime tried_{};
  /// When the next byte, or frame, is due.
  SteadyTime due_{};
};

void Flood::Act() {
  const SteadyTime now = world_.clock.Steady();
  if (stream_ != nullptr && stream_->state() != BadStream::State::kOver) {
    const bool open = stream_->state() == BadStream::State::kOpen;
    const milliseconds life = open ? style_.left_after : kWelcomeWait;
    if (life.count() > 0 && now - stream_->since() > life) Leave();
  }
  OpenIfOver(now);
  if (stream_->state() == BadStream::State::kOpen) SendWhatIsDue(now);
}

void Flood::Leave() {
  stream_->Freeze();
  left_.push_back(std::move(stream_));
  if (left_.size() <= kLeftMax) return;
  left_.front()->Cut();
  left_.pop_front();
}

void Flood::OpenIfOver(SteadyTime now) {
  if (stream_ != nullptr && stream_->state() != BadStream::State::kOver) return;
  if (stream_ != nullptr && now - tried_ < kRetry) return;
  tried_ = now;
  if (stream_ != nullptr && stream_->reusable()) {
    stream_->OpenAgain();
  } else {
    stream_ = std::make_unique<BadStream>(world_, session_, BadStream::Confirms::kAcks);
  }
}

void Flood::SendWhatIsDue(SteadyTime now) {
  due_ = std::max(due_, now - kCatchUpMax);
  for (int i = 0; i < kFramesAnAct && due_ <= now && stream_->unsent() < kUnsentMax; ++i) {
    const std::vector<BadMessage> frame = style_.frame();
    stream_->Send(frame, style_.step());
    at_work_ = true;
    due_ += style_.pause;
    if (style_.bytes_per_second == 0) continue;
    std::size_t bytes = 0;
    for (const BadMessage& message : frame) bytes += message.bytes.size();
    due_ += duration_cast<SteadyTime::duration>(duration<double>(
        static_cast<double>(bytes) / static_cast<double>(style_.bytes_per_second)));
  }
}

}  // namespace

std::unique_ptr<Misbehaviour> MakeFlood(BadWorld& world, FloodStyle style) {
  return std::make_unique<Flood>(world, std::move(style));
}

}  // namespace uplink::bench
