#include "tools/uplink-fleet/twin/joint_updates.h"

#include <array>
#include <utility>

#include <fmt/core.h>

namespace uplink::synthetic {
namespace {

namespace js = boost::json;

constexpr const char* kSingle = "elbow";
constexpr std::array<const char*, 3> kMapped = {"_1", "_2", "_3"};
constexpr std::array<const char*, 2> kFlat = {"wrist_1", "wrist_2"};
constexpr const char* kState = "gripper";
constexpr std::array<std::pair<const char*, const char*>, 3> kChannels = {
    {{"positions", "position"}, {"velocities", "velocity"}, {"efforts", "effort"}}};

}  // namespace

double JointUpdates::Angle() { return speech_.chance.Between(-3, 3); }

void JointUpdates::Channel(Side side, const std::string& group, const std::string& joint,
                           const char* channel, double value) {
  speech_.account.Live(side, fmt::format("joints/{}/{}/{}", group, joint, channel), value);
}

void JointUpdates::Time(Side side, const std::string& group, const std::string& joint,
                        const Draft& draft) {
  speech_.account.Live(side, fmt::format("joints/{}/{}/timestamp", group, joint),
                       SecondsOf(draft.time_us));
  speech_.account.SignOfLife(side, speech_.voice.now_us());
}

Publication JointUpdates::Single() {
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "edge");
  js::object state;
  for (const auto& [map, channel] : kChannels) {
    const double value = Angle();
    state[channel] = value;
    Channel(Side::kReal, "edge", kSingle, channel, value);
  }
  Time(Side::kReal, "edge", kSingle, draft);
  draft.body["joint_name"] = kSingle;
  draft.body["joint_state"] = std::move(state);
  return speech_.voice.ToJoints(draft);
}

Publication JointUpdates::SinglePosition() {
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "edge");
  const double value = Angle();
  Channel(Side::kReal, "edge", kSingle, "position", value);
  Time(Side::kReal, "edge", kSingle, draft);
  draft.body["joint_name"] = kSingle;
  // Null is absent.
  draft.body["joint_state"] = js::object{{"position", value}, {"velocity", nullptr}};
  return speech_.voice.ToJoints(draft);
}

Publication JointUpdates::Maps(Side side, Speaker speaker, const std::string& group) {
  Draft draft = speech_.voice.Begin(speaker, group);
  for (const auto& [map, channel] : kChannels) {
    js::object values;
    for (const char* joint : kMapped) {
      const double value = Angle();
      values[joint] = value;
      Channel(side, group, joint, channel, value);
    }
    draft.body[map] = std::move(values);
  }
  for (const char* joint : kMapped) Time(side, group, joint, draft);
  return speech_.voice.ToJoints(draft);
}

Publication JointUpdates::Follower() {
  return Maps(Side::kReal, Speaker::kDriver, "edge_follower");
}
Publication JointUpdates::Leader() { return Maps(Side::kReal, Speaker::kDriver, "edge_leader"); }
Publication JointUpdates::Simulated() { return Maps(Side::kSim, Speaker::kSimulation, "sim"); }

Publication JointUpdates::Flat() {
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "edge");
  draft.body.erase("timestamp");
  for (const char* joint : kFlat) {
    const double value = Angle();
    draft.body[joint] = value;
    Channel(Side::kReal, "edge", joint, "position", value);
  }
  draft.body["mode"] = 3;
  speech_.account.SignOfLife(Side::kReal, speech_.voice.now_us());
  return speech_.voice.ToJoints(draft);
}

Publication JointUpdates::States() {
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "");
  const double value = Angle();
  draft.body["joint_states"] = js::object{{kState, value}};
  Channel(Side::kReal, "edge", kState, "position", value);
  Time(Side::kReal, "edge", kState, draft);
  return speech_.voice.ToTwin(draft, "joint_states", Qos::k0);
}

Publication JointUpdates::Setpoints() {
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "edge");
  draft.body["target_positions"] = js::object{{kSingle, Angle()}, {"wanted_only", Angle()}};
  speech_.account.SignOfLife(Side::kReal, speech_.voice.now_us());
  return speech_.voice.ToJoints(draft);
}

Publication JointUpdates::Teleoperated() {
  Draft draft = speech_.voice.Begin(Speaker::kViewer, "tele");
  draft.body["joint_name"] = kSingle;
  draft.body["joint_state"] = js::object{{"position", Angle()}};
  return speech_.voice.ToJoints(draft);
}

}  // namespace uplink::synthetic
