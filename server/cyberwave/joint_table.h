#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schema/model/cyberwave/head.h"
#include "schema/model/cyberwave/joints.h"
#include "schema/model/rejection.h"
#include "server/cyberwave/held.h"

namespace uplink::cyberwave {

/// Whose joints: a leader and its follower use the same names.
enum class JointGroup : std::uint8_t { kEdge, kLeader, kFollower, kSim };
inline constexpr std::size_t kJointGroups = 4;

/// The vendor's word of the source type: `edge_leader`.
[[nodiscard]] std::string_view ToText(JointGroup group);
/// The group of what a source says of joints; a word that we do not know is the edge's. Nothing for
/// a source of commands.
[[nodiscard]] std::optional<JointGroup> JointGroupOf(model::cyberwave::SourceType type);

/// What is known of one joint; units as the model's. A value.
struct HeldJoint {
  std::optional<double> position;
  std::optional<double> velocity;
  std::optional<double> effort;
  bool prismatic = false;
  /// What the source called itself, if it is none of the words that we know.
  std::string other_source;
  Stamp stamp;
  SessionTimes times;
};

/// What one message said, for all of its joints. A value.
struct SaidJoints {
  JointGroup group = JointGroup::kEdge;
  model::cyberwave::Source source;
  Stamp stamp;
  SessionNumber session = 0;
};

/// The joints of one robot by source type and name. A value.
///
/// Limits:  kJointNamesMax names of each source type; a name stays for ever.
class JointTable final {
 public:
  using ByName = std::map<std::string, HeldJoint, std::less<>>;

  /// What became of the joints of one message. A value.
  struct Taken {
    std::size_t applied = 0;
    /// Older than what was said last.
    std::size_t superseded = 0;
    /// Those that have no room: the first ones (schema::kToldFieldsMax), and how many there are.
    std::vector<model::DroppedField> dropped;
    std::size_t without_room = 0;
  };
  Taken Take(const std::vector<model::cyberwave::Joint>& joints, const SaidJoints& said);

  [[nodiscard]] const ByName& Of(JointGroup group) const {
    return groups_[static_cast<std::size_t>(group)];
  }

 private:
  /// What `held` has of the joint; null if it is new and has no room. `next` is looked at first,
  /// and is the one behind it from then on.
  [[nodiscard]] static HeldJoint* Find(const std::string& name, ByName& held,
                                       ByName::iterator& next);

  std::array<ByName, kJointGroups> groups_;
};

}  // namespace uplink::cyberwave
