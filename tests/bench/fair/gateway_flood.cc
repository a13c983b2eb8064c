#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "tests/bench/fair/bad_payloads.h"
#include "tests/bench/fair/misbehaviour.h"
#include "tools/link/http2_link.h"

namespace uplink::bench {
namespace {

/// Streams of the gateway, each for a robot of its own, and its connections.
constexpr std::size_t kGatewayStreams = 50;
constexpr std::size_t kGatewayLinks = 5;
/// Of a frame.
constexpr std::size_t kEventsAFrame = 64;
/// Of one robot, that wait for the server at most: it is asked for more soon enough.
constexpr std::size_t kUnsentMax = std::size_t{64} * 1024;
/// Between two tries after a connection or a stream ended.
constexpr milliseconds kRetry{200};

class GatewayFlood final : public Misbehaviour {
 public:
  GatewayFlood(BadWorld& world, const std::string& ruri);

  void Act() override;
  [[nodiscard]] bool at_work() const override { return at_work_; }

 private:
  struct Robot {
    BadSession session;
    std::unique_ptr<BadStream> stream;
    std::uint64_t events = 0;
  };
  struct Link {
    std::shared_ptr<link::Http2Link> link;
    std::vector<Robot> robots;
    SteadyTime tried;
  };

  void Mend(Link& link, SteadyTime now);
  void SendEvents(Robot& robot);

  BadWorld& world_;
  std::vector<Link> links_;
  bool at_work_ = false;
};

GatewayFlood::GatewayFlood(BadWorld& world, const std::string& ruri)
    : world_(world), links_(kGatewayLinks) {
  std::size_t number = 0;
  for (std::string& robot_ruri : RobotsOfGateway(ruri)) {
    Robot& robot = links_[number++ % kGatewayLinks].robots.emplace_back();
    robot.session = NewBadSession();
    robot.session.ruri = std::move(robot_ruri);
  }
}

void GatewayFlood::Act() {
  const SteadyTime now = world_.clock.Steady();
  bool all = true;
  for (Link& link : links_) {
    Mend(link, now);
    for (Robot& robot : link.robots) {
      if (robot.stream == nullptr || robot.stream->state() != BadStream::State::kOpen) {
        all = false;
      } else {
        SendEvents(robot);
      }
    }
  }
  at_work_ = at_work_ || all;
}

void GatewayFlood::Mend(Link& link, SteadyTime now) {
  const auto over = [](const Robot& robot) {
    return robot.stream == nullptr || robot.stream->state() == BadStream::State::kOver;
  };
  if (!std::ranges::any_of(link.robots, over)) return;
  if (link.link != nullptr && now - link.tried < kRetry) return;
  link.tried = now;
  if (link.link == nullptr || link.link->over()) {
    for (Robot& robot : link.robots) robot.stream.reset();
    link.link =
        std::make_shared<link::Http2Link>(world_.loop, world_.link, link::Http2Link::For::kSeveral);
  }
  for (Robot& robot : link.robots) {
    if (!over(robot)) continue;
    robot.stream.reset();
    robot.stream = std::make_unique<BadStream>(world_, robot.session, link.link);
  }
}

void GatewayFlood::SendEvents(Robot& robot) {
  if (robot.stream->unsent() >= kUnsentMax) return;
  std::vector<BadMessage> frame;
  for (std::size_t i = 0; i < kEventsAFrame; ++i) frame.push_back({GoodEvent(++robot.events)});
  robot.stream->Send(frame);
}

}  // namespace

std::vector<std::string> RobotsOfGateway(const std::string& ruri) {
  std::vector<std::string> ruris;
  for (std::size_t i = 0; i < kGatewayStreams; ++i) ruris.push_back(fmt::format("{}-{}", ruri, i));
  return ruris;
}

std::unique_ptr<Misbehaviour> MakeGatewayFlood(BadWorld& world, const std::string& ruri) {
  return std::make_unique<GatewayFlood>(world, ruri);
}

}  // namespace uplink::bench
