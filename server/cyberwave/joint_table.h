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

/// Which part of a robot has the joints: a leader and its follower use the same names.
enum class JointGroup : std::uint8_t { kEdge, kLeader, kFollower, kSim };
inline constexpr std::size_t kJointGroups = 4;

/// The vendor's word for the source type: `edge_leader`.
[[nodiscard]] std::string_view ToText(JointGroup group);
/// The group of joints that such a source reports; kEdge for a word that we do not know. Empty for
/// a source of commands.
[[nodiscard]] std::optional<JointGroup> JointGroupOf(model::cyberwave::SourceType type);

/// The known values of one joint; units as the model's. A value.
struct HeldJoint {
  std::optional<double> position;
  std::optional<double> velocity;
  std::optional<double> effort;
  bool prismatic = false;
  /// The source's own word, if we do not know it.
  std::string other_source;
  Stamp stamp;
  SessionTimes times;
};

/// The facts that hold for all joints of one message. A value.
struct SaidJoints {
  JointGroup group = JointGroup::kEdge;
  model::cyberwave::Source source;
  Stamp stamp;
  SessionNumber session = 0;
};

/// The joints of one robot by source type and name. A value.
///
/// Limits:  kJointNamesMax names of each source type; a name stays until the table is dropped.
class JointTable final {
 public:
  using ByName = std::map<std::string, HeldJoint, std::less<>>;

  /// What became of one message's joints. A value.
  struct Taken {
    std::size_t applied = 0;
    /// Older than the value before.
    std::size_t superseded = 0;
    /// Joints without room: the first ones (schema::kDroppedFieldsListedMax), and how many there
    /// are.
    std::vector<model::DroppedField> dropped;
    std::size_t without_room = 0;
  };
  Taken Take(const std::vector<model::cyberwave::Joint>& joints, const SaidJoints& said);

  [[nodiscard]] const ByName& Of(JointGroup group) const {
    return groups_[static_cast<std::size_t>(group)];
  }

 private:
  /// The joint's entry in `held`; null if it is new and has no room. `next` is tried first, and
  /// becomes the entry behind.
  [[nodiscard]] static HeldJoint* Find(const std::string& name, ByName& held,
                                       ByName::iterator& next);

  std::array<ByName, kJointGroups> groups_;
};

}  // namespace uplink::cyberwave
