#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tests/bench/fair/bad_stream.h"

namespace uplink::bench {

/// One way to be bad. Never waits: what it waits for it looks at in the next Act.
///
/// Thread: confined to the loop's thread.
class Misbehaviour {
 public:
  virtual ~Misbehaviour() = default;
  /// Does what is due now. Called after every event of the loop, never within one, and at
  /// least every few milliseconds.
  virtual void Act() = 0;
  /// What had to be prepared is done, and it has begun.
  [[nodiscard]] virtual bool at_work() const = 0;
};

/// What the bad robot, or gateway, does to its server.
struct Misdeed {
  std::string_view name;
  /// A line for people.
  std::string_view about;
  /// `world` outlives what it makes; `ruri` is the bad robot's own.
  std::unique_ptr<Misbehaviour> (*make)(BadWorld& world, const std::string& ruri) = nullptr;
  /// Its certificate is a gateway's, of RobotsOfGateway.
  bool by_gateway = false;
  /// Robots are scraped meanwhile, or the bad one's page is looked at: there it grows.
  bool robots_scraped = false;
  bool page_looked_at = false;
};
/// In the order of a whole run.
[[nodiscard]] std::span<const Misdeed> Misdeeds();
/// Null if there is none of that name.
[[nodiscard]] const Misdeed* MisdeedOf(std::string_view name);

/// How a flood sends frames on one stream, and opens the next when it ends.
struct FloodStyle {
  /// Messages of the next frame.
  std::function<std::vector<BadMessage>()> frame = {};
  /// How far the numbers of the next frame's messages are apart.
  std::function<std::uint64_t()> step = [] { return std::uint64_t{1}; };
  /// Bytes of payloads per second; 0: as fast as the server reads.
  std::size_t bytes_per_second = 0;
  /// Between frames; zero: none.
  milliseconds pause{0};
  /// How long a stream stays before it is left as it is, and another is opened; zero: as long as it
  /// lives.
  milliseconds left_after{0};
};
[[nodiscard]] std::unique_ptr<Misbehaviour> MakeFlood(BadWorld& world, FloodStyle style);
/// Has thousands of messages rejected, then opens stream after stream that confirms none of them,
/// and leaves each at its Welcome, or as soon as the server has begun to say them again.
[[nodiscard]] std::unique_ptr<Misbehaviour> MakeRejectStorm(BadWorld& world,
                                                            const std::string& ruri);
/// Two connections with a session each. Whichever lost the robot takes it back at once.
[[nodiscard]] std::unique_ptr<Misbehaviour> MakeTakeoverWar(BadWorld& world,
                                                            const std::string& ruri);
/// A gateway all of whose robots, RobotsOfGateway(ruri), send events as fast as they are read.
[[nodiscard]] std::unique_ptr<Misbehaviour> MakeGatewayFlood(BadWorld& world,
                                                             const std::string& ruri);
/// The robots of the gateway: their names begin with `ruri`.
[[nodiscard]] std::vector<std::string> RobotsOfGateway(const std::string& ruri);

}  // namespace uplink::bench
