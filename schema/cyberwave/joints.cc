#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "schema/cyberwave/families.h"
#include "schema/limits.h"
#include "schema/rules/describe.h"
#include "schema/rules/texts.h"

namespace uplink::cyberwave {
namespace {

namespace js = boost::json;
using model::cyberwave::Joint;
using model::cyberwave::Joints;
using schema::Path;
using schema::Violations;

constexpr std::array<std::string_view, 3> kMaps = {"positions", "velocities", "efforts"};
/// Wanted values, in all three formats.
constexpr std::array<std::string_view, 5> kSetpoints = {"target_positions", "target_velocities",
                                                        "target_efforts", "target_joint_state",
                                                        "applied_position_targets"};
/// Numbers beside the joints of a flat message.
constexpr std::array<std::string_view, 8> kNoJoints = {
    "timestamp", "ts", "ts_raw", "ts_norm", "ts_unix", "ts_us", "mode", "update_mode"};

/// Maps of joint to number, by channel; null where a message has none.
using Channels = std::array<const js::object*, kMaps.size()>;

bool Contains(std::span<const std::string_view> names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

const js::value* ValueIn(const js::object* map, js::string_view key) {
  const js::value* value = map == nullptr ? nullptr : map->if_contains(key);
  return value == nullptr || value->is_null() ? nullptr : value;
}

/// The joint without values, or nothing after reporting what is wrong with its name.
std::optional<Joint> Named(Violations& violations, const Path& path, std::string_view name,
                           const Names& prismatic) {
  if (name.empty()) {
    violations.Content(schema::MissingField(path, "has a joint without a name"));
    return std::nullopt;
  }
  std::optional<std::string> kept = schema::Text(violations, path, name, schema::kNameBytesMax);
  if (!kept) return std::nullopt;
  Joint joint;
  joint.prismatic = !prismatic.empty() && prismatic.contains(*kept);
  joint.name = *std::move(kept);
  return joint;
}

/// Rejects more than a message may have.
bool TooMany(Violations& violations, const Path& path, std::size_t count) {
  if (count <= kJointsMax) return false;
  violations.Reject(schema::TooManyItems(path, count, kJointsMax, "joints"));
  return true;
}

std::size_t ValuesIn(const js::object& map) {
  const auto there = [](const auto& member) { return !member.value().is_null(); };
  return static_cast<std::size_t>(std::count_if(map.begin(), map.end(), there));
}

std::size_t SetpointsOf(Reader& in) {
  std::size_t setpoints = 0;
  for (const std::string_view name : kSetpoints) {
    const js::value* value = in.Find(name);
    if (value == nullptr || !value->is_object()) continue;
    const Path path = in.path().Field(name);
    const std::size_t values = ValuesIn(value->get_object());
    if (TooMany(in.violations(), path, values)) return 0;
    setpoints += values;
  }
  return setpoints;
}

/// `joint_name` and `joint_state`.
std::vector<Joint> SingleJoint(Reader& in, const js::object& state, const Names& prismatic) {
  Joint joint;
  joint.name = in.Text("joint_name", schema::kNameBytesMax, Need::kMust);
  joint.prismatic = prismatic.contains(joint.name);
  const Path path = in.path().Field("joint_state");
  Reader values(state, path, in.violations());
  joint.position = values.Number("position");
  joint.velocity = values.Number("velocity");
  joint.effort = values.Number("effort");
  if (!joint.position && !joint.velocity && !joint.effort) in.violations().RejectIfAnyDropped();
  return {std::move(joint)};
}

/// What the channels from `first` on say of one joint; an invalid value is dropped alone.
std::optional<Joint> JointOf(Reader& in, const Channels& channels, std::size_t first,
                             js::string_view key, const Names& prismatic) {
  const std::string_view name = FromBoost(key);
  std::array<std::optional<double>, kMaps.size()> values;
  const Path map = in.path().Field(kMaps.at(first));
  const Path named = map.Key(name);
  std::optional<Joint> joint = Named(in.violations(), named, name, prismatic);
  if (!joint) return std::nullopt;
  bool any = false;
  for (std::size_t i = first; i < channels.size(); ++i) {
    const js::value* value = ValueIn(channels.at(i), key);
    if (value == nullptr) continue;
    const Path channel = in.path().Field(kMaps.at(i));
    const Path field = channel.Key(name);
    values.at(i) = NumberOf(in.violations(), field, *value);
    any = any || values.at(i);
  }
  if (!any) return std::nullopt;
  joint->position = values[0];
  joint->velocity = values[1];
  joint->effort = values[2];
  return joint;
}

/// Calls `each(channel, key)` for every joint once, with the first channel that has it.
template <typename Each>
void ForEachJoint(const Channels& channels, Each each) {
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const js::object* const channel = channels.at(i);
    if (channel == nullptr) continue;
    for (const auto& member : *channel) {
      if (member.value().is_null()) continue;
      const auto earlier = channels.begin() + static_cast<std::ptrdiff_t>(i);
      const bool before = std::any_of(channels.begin(), earlier, [&member](const js::object* map) {
        return ValueIn(map, member.key()) != nullptr;
      });
      if (!before) each(i, member.key());
    }
  }
}

std::vector<Joint> MappedJoints(Reader& in, const Channels& channels, const Names& prismatic) {
  std::size_t count = 0;
  ForEachJoint(channels, [&count](std::size_t /*channel*/, js::string_view /*key*/) { ++count; });
  std::vector<Joint> joints;
  if (TooMany(in.violations(), in.path(), count)) return joints;
  joints.reserve(count);
  ForEachJoint(channels, [&](std::size_t channel, js::string_view key) {
    std::optional<Joint> joint = JointOf(in, channels, channel, key, prismatic);
    if (joint) joints.push_back(*std::move(joint));
  });
  return joints;
}

bool IsFlatJoint(const js::key_value_pair& member) {
  const std::string_view name = FromBoost(member.key());
  return member.value().is_number() && !Contains(kNoJoints, name) && !Contains(kSetpoints, name);
}

/// The positions in a map; `is_joint` says which members are joints.
template <typename IsJoint>
std::vector<Joint> PositionsOf(Violations& violations, const Path& path, const js::object& map,
                               const Names& prismatic, IsJoint is_joint) {
  std::size_t count = map.size();
  // What all members together are not, those that are joints are not either.
  if (count > kJointsMax) {
    count = static_cast<std::size_t>(std::count_if(map.begin(), map.end(), is_joint));
  }
  std::vector<Joint> joints;
  if (TooMany(violations, path, count)) return joints;
  joints.reserve(count);
  for (const auto& member : map) {
    if (!is_joint(member)) continue;
    const std::string_view name = FromBoost(member.key());
    const Path field = path.Key(name);
    std::optional<Joint> joint = Named(violations, field, name, prismatic);
    if (!joint) continue;
    joint->position = NumberOf(violations, field, member.value());
    if (joint->position) joints.push_back(*std::move(joint));
  }
  return joints;
}

bool HasMaps(const Reader& in) {
  return std::any_of(kMaps.begin(), kMaps.end(), [&in](std::string_view name) {
    const js::value* value = in.Find(name);
    return value != nullptr && value->is_object();
  });
}

std::vector<Joint> JointsOf(Reader& in, const Names& prismatic) {
  const js::value* state = in.Find("joint_state");
  if (in.Find("joint_name") != nullptr && state != nullptr && state->is_object()) {
    return SingleJoint(in, state->get_object(), prismatic);
  }
  if (!HasMaps(in)) {
    return PositionsOf(in.violations(), in.path(), in.object(), prismatic, IsFlatJoint);
  }
  Channels channels{};
  for (std::size_t i = 0; i < kMaps.size(); ++i) {
    channels.at(i) = in.Object(kMaps.at(i), Need::kMay);
  }
  return MappedJoints(in, channels, prismatic);
}

}  // namespace

Joints ReadJointUpdate(Reader& in, const Names& prismatic) {
  Joints joints;
  joints.joints = JointsOf(in, prismatic);
  joints.setpoints = SetpointsOf(in);
  if (joints == Joints()) in.violations().RejectIfAnyDropped();
  return joints;
}

Joints ReadJointStates(Reader& in, const Names& prismatic) {
  Joints joints;
  const js::object* states = in.Object("joint_states", Need::kMay);
  if (states != nullptr) {
    const Path path = in.path().Field("joint_states");
    const auto there = [](const auto& member) { return !member.value().is_null(); };
    joints.joints = PositionsOf(in.violations(), path, *states, prismatic, there);
  }
  if (joints.joints.empty()) in.violations().RejectIfAnyDropped();
  return joints;
}

}  // namespace uplink::cyberwave
