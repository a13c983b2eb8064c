#include "tests/simulation/sim_forwards.h"

#include <utility>
#include <vector>

#include "schema/base/check.h"
#include "server/forward/limits.h"
#include "tests/support/kept_lines.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::simulation {
namespace {

/// A planted fault: of all snapshots the stream gets the first alone.
class OneSnapshot final : public session::ForwardReceiver {
 public:
  explicit OneSnapshot(std::unique_ptr<session::ForwardReceiver> inner)
      : inner_(std::move(inner)) {}

  void Take(std::vector<session::EncodedFrame>& into) override {
    std::vector<session::EncodedFrame> taken;
    do {
      taken.clear();
      inner_->Take(taken);
      for (session::EncodedFrame& frame : taken) {
        if (Passes(*frame)) into.push_back(std::move(frame));
      }
    } while (into.empty() && !taken.empty());
  }

 private:
  bool Passes(const std::string& bytes) {
    v1::RelayResponse frame;
    UPLINK_CHECK(frame.ParseFromString(bytes), "an encoded frame is one");
    const v1::ForwardKind kind = frame.forward().kind();
    if (kind == v1::FORWARD_KIND_SNAPSHOT_BEGIN) swallows_ = std::exchange(had_one_, true);
    if (!swallows_) return true;
    if (kind == v1::FORWARD_KIND_SNAPSHOT_END) swallows_ = false;
    return false;
  }

  const std::unique_ptr<session::ForwardReceiver> inner_;
  bool had_one_ = false;
  bool swallows_ = false;
};

}  // namespace

SimForwards::SimForwards(const Clock& clock, const ForwardSetup& setup)
    : fault_(setup.fault),
      random_(setup.seed),
      logger_(std::make_unique<testing::NoLines>(), clock, log::Format::kText, log::Level::kInfo),
      forwards_(
          {forward::kSharedBytesMax, forward::kFleetBytesMax, forward::kRobotBytesMax},
          [this] { return random_.Next(); }, setup.receivers),
      rounds_({clock, logger_, *setup.items, forwards_, probe_, clock_trust_}) {
  if (fault_ == ForwardFault::kBeginsBeforeWhole) forwards_.SetWhole();
}

std::unique_ptr<session::ForwardReceiver> SimForwards::Join(const model::RobotId& robot,
                                                            loop::StreamRef stream) {
  model::RobotId as = robot;
  if (fault_ == ForwardFault::kOtherFleet) as.fleet = "sim";
  if (fault_ == ForwardFault::kOwnItems) as.ruri += "/another";
  auto receiver = forwards_.Join(as, stream);
  if (fault_ != ForwardFault::kDropsWhenFull) return receiver;
  return std::make_unique<OneSnapshot>(std::move(receiver));
}

}  // namespace uplink::simulation
