#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace uplink::rcan {

/// By which way a robot's messages come.
enum class Way : std::uint8_t {
  kGateway,
  /// By streams of the robot's own certificate.
  kOwnStream,
  kBroker,
  /// No stream of the robot came in this life of the server.
  kNotHeard,
};
[[nodiscard]] std::string_view ToText(Way way);

/// Robots of one fleet that come by the same way, of gateways by the same one. They share the room
/// that a scrape has for them. A value.
struct Sharer {
  std::string fleet;
  Way way = Way::kNotHeard;
  /// The subject of the gateway's certificate; empty unless the way is kGateway.
  std::string gateway = {};

  auto operator<=>(const Sharer&) const = default;
};

/// In which order the robots take the room of a scrape. The turn is always with the fleet that has
/// taken least, and in it with the sharer that has taken least. So when the room ends, each has all
/// that it wants, or as much as any other to within one robot: a sharer of many large robots is
/// short of room itself, and no other is.
///
/// Limits:  as many entries as robots were added.
/// Thread:  confined to its owner.
class ScrapeTurns final {
 public:
  /// What came of one robot's turn, in series.
  struct Turn {
    std::size_t taken = 0;
    /// There was no room for them.
    std::size_t left_out = 0;
  };

  /// Forgets all robots, and what they took.
  void Clear() { groups_.clear(); }
  /// The robots of a sharer have their turns in the order in which they are added.
  void Add(Sharer sharer, std::size_t robot);

  /// Gives each robot one turn. What was taken at an earlier call does not count for the order.
  void Give(const std::function<Turn(std::size_t robot)>& turn);

  struct Share {
    Sharer sharer;
    /// Of all turns.
    Turn series;
  };
  /// Of those who lack room the one that wanted most; nothing if nothing was left out.
  [[nodiscard]] std::optional<Share> Greediest() const;

 private:
  struct Group {
    std::vector<std::size_t> robots;
    Turn series;
  };
  /// By fleet first.
  std::map<Sharer, Group> groups_;
};

}  // namespace uplink::rcan
