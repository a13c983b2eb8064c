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

/// The way by which a robot's messages come.
enum class Way : std::uint8_t {
  kGateway,
  /// By streams of the robot's own certificate.
  kOwnStream,
  kBroker,
  /// The robot had no stream since the server's start.
  kNotHeard,
};
[[nodiscard]] std::string_view ToText(Way way);

/// Robots of one fleet that come by the same way, and by the same gateway. They share the room that
/// a scrape has for them. A value.
struct Sharer {
  std::string fleet;
  Way way = Way::kNotHeard;
  /// The subject of the gateway's certificate; empty unless the way is kGateway.
  std::string gateway = {};

  auto operator<=>(const Sharer&) const = default;
};

/// The order in which robots take the room of a scrape. The next turn goes to the fleet that has
/// taken least, and in it to the sharer that has taken least. So when the room ends, each has all
/// that it wants, or as much as any other to within one robot: many large robots of one sharer
/// leave only that sharer short.
///
/// Limits:  as many entries as robots were added.
/// Thread:  confined to its owner.
class ScrapeTurns final {
 public:
  /// The result of one robot's turn, in series.
  struct Turn {
    std::size_t taken = 0;
    /// There was no room for them.
    std::size_t left_out = 0;
  };

  /// Forgets all robots and their turns.
  void Clear() { groups_.clear(); }
  /// The robots of a sharer take turns in the order in which they are added.
  void Add(Sharer sharer, std::size_t robot);

  /// Gives each robot one turn. Series that were taken at an earlier call do not count.
  void Give(const std::function<Turn(std::size_t robot)>& turn);

  struct Share {
    Sharer sharer;
    /// The sum of its turns.
    Turn series;
  };
  /// The sharer that wanted most of those that lack room; empty if nothing was left out.
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
