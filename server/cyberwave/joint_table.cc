#include "server/cyberwave/joint_table.h"

#include <iterator>

#include "schema/limits.h"
#include "schema/rules/describe.h"

namespace uplink::cyberwave {
namespace {

using model::cyberwave::Joint;
using model::cyberwave::SourceType;

model::DroppedField NoRoomFor(const Joint& joint) {
  const schema::Path root;
  const schema::Path path = root.Key(joint.name);
  return schema::TooManyItems(path, kJointNamesMax + 1, kJointNamesMax, "names of joints")
      .Describe();
}

void SetIf(std::optional<double>& channel, const std::optional<double>& said) {
  if (said) channel = said;
}

void Keep(HeldJoint& known, const Joint& joint, const SaidJoints& said) {
  SetIf(known.position, joint.position);
  SetIf(known.velocity, joint.velocity);
  SetIf(known.effort, joint.effort);
  known.prismatic = joint.prismatic;
  known.other_source = said.source.type == SourceType::kUnknown ? said.source.text : "";
  known.stamp = said.stamp;
}

bool SaysNothing(const Joint& joint) { return !joint.position && !joint.velocity && !joint.effort; }

}  // namespace

std::string_view ToText(JointGroup group) {
  switch (group) {
    case JointGroup::kEdge:
      return model::cyberwave::ToText(SourceType::kEdge);
    case JointGroup::kLeader:
      return model::cyberwave::ToText(SourceType::kEdgeLeader);
    case JointGroup::kFollower:
      return model::cyberwave::ToText(SourceType::kEdgeFollower);
    case JointGroup::kSim:
      return model::cyberwave::ToText(SourceType::kSim);
  }
  return "";
}

std::optional<JointGroup> JointGroupOf(SourceType type) {
  switch (type) {
    case SourceType::kEdge:
    case SourceType::kUnknown:
      return JointGroup::kEdge;
    case SourceType::kEdgeLeader:
      return JointGroup::kLeader;
    case SourceType::kEdgeFollower:
      return JointGroup::kFollower;
    case SourceType::kSim:
      return JointGroup::kSim;
    case SourceType::kTele:
    case SourceType::kSimTele:
    case SourceType::kEdit:
    case SourceType::kPreview:
      break;
  }
  return std::nullopt;
}

HeldJoint* JointTable::Find(const std::string& name, ByName& held, ByName::iterator& next) {
  auto found = next != held.end() && next->first == name ? next : held.find(name);
  if (found == held.end()) {
    if (held.size() >= kJointNamesMax) return nullptr;
    found = held.emplace(name, HeldJoint()).first;
  }
  next = std::next(found);
  return &found->second;
}

JointTable::Taken JointTable::Take(const std::vector<Joint>& joints, const SaidJoints& said) {
  Taken taken;
  ByName& held = groups_[static_cast<std::size_t>(said.group)];
  // Most messages name joints in the order of the table.
  ByName::iterator next = held.begin();
  for (const Joint& joint : joints) {
    // A joint that is named without a value gets an entry without values.
    if (SaysNothing(joint)) {
      ++taken.applied;
      continue;
    }
    HeldJoint* known = Find(joint.name, held, next);
    if (known == nullptr) {
      ++taken.without_room;
      if (taken.dropped.size() < schema::kDroppedFieldsListedMax)
        taken.dropped.push_back(NoRoomFor(joint));
      continue;
    }
    if (!known->times.Take(said.session, said.stamp.timestamp_us)) {
      ++taken.superseded;
      continue;
    }
    ++taken.applied;
    Keep(*known, joint, said);
  }
  return taken;
}

}  // namespace uplink::cyberwave
