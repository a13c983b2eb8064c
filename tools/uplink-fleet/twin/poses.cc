#include "tools/uplink-fleet/twin/poses.h"

#include <cmath>

namespace uplink::synthetic {
namespace {

namespace js = boost::json;

constexpr double kFieldM = 50;
constexpr double kTurn = 6.283185307179586;
constexpr double kFullCircleDeg = 360;

}  // namespace

void Poses::Say(Side side, const Draft& draft, const char* path, const js::object& fields,
                std::string_view source) {
  speech_.account.Live(side, path, AsShown(draft, fields, source));
  speech_.account.SignOfLife(side, speech_.voice.now_us());
}

js::object Poses::Place() {
  Seeded& chance = speech_.chance;
  return {{"x", chance.Between(-kFieldM, kFieldM)},
          {"y", chance.Between(-kFieldM, kFieldM)},
          {"z", chance.Between(0, 2)}};
}

Publication Poses::Position() {
  // A word that nobody knows counts as edge, and is kept.
  constexpr double kOddWord = 0.05;
  const char* source = speech_.chance.Chance(kOddWord) ? "edge_v2" : "edge";
  Draft draft = speech_.voice.Begin(Speaker::kDriver, source);
  draft.body["type"] = "position";
  const js::object place = Place();
  draft.body["position"] = place;
  Say(Side::kReal, draft, "position", place, source);
  return speech_.voice.ToTwin(draft, "position", Qos::k0);
}

Publication Poses::SimulatedPosition() {
  // Half of them let the session say that they are simulated.
  Draft draft = speech_.voice.Begin(Speaker::kSimulation, speech_.chance.Chance(0.5) ? "sim" : "");
  const js::object place = Place();
  draft.body["position"] = place;
  Say(Side::kSim, draft, "position", place, "sim");
  return speech_.voice.ToTwin(draft, "position", Qos::k0);
}

Publication Poses::Rotation() {
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "edge");
  const double half = speech_.chance.Between(0, kTurn) / 2;
  // What is not said is that of no rotation.
  draft.body["rotation"] = js::object{{"w", std::cos(half)}, {"z", std::sin(half)}};
  const js::object shown{{"w", std::cos(half)}, {"x", 0.0}, {"y", 0.0}, {"z", std::sin(half)}};
  Say(Side::kReal, draft, "rotation", shown, "edge");
  return speech_.voice.ToTwin(draft, "rotation", Qos::k0);
}

Publication Poses::SimulatedRotation() {
  Draft draft = speech_.voice.Begin(Speaker::kSimulation, "sim");
  // All zero is no rotation, too.
  draft.body["rotation"] = js::object{{"w", 0.0}, {"x", 0.0}, {"y", 0.0}, {"z", 0.0}};
  const js::object shown{{"w", 1.0}, {"x", 0.0}, {"y", 0.0}, {"z", 0.0}};
  Say(Side::kSim, draft, "rotation", shown, "sim");
  return speech_.voice.ToTwin(draft, "rotation", Qos::k0);
}

Publication Poses::Scale() {
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "edge");
  const js::object scale{{"x", 1}, {"y", 1}, {"z", speech_.chance.Between(1, 2)}};
  draft.body["scale"] = scale;
  Say(Side::kReal, draft, "scale", scale, "edge");
  return speech_.voice.ToTwin(draft, "scale", Qos::k0);
}

Publication Poses::Gps() {
  Seeded& chance = speech_.chance;
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "");
  const js::object fields{{"latitude", chance.Between(47, 48)},
                          {"longitude", chance.Between(8, 9)},
                          {"altitude", chance.Between(400, 500)},
                          {"compass_heading", chance.Between(0, kFullCircleDeg - 1)},
                          {"satellite_count", 7 + static_cast<int>(chance.Below(5))},
                          {"fix_type", "rtk_fixed"}};
  for (const auto& field : fields) draft.body[field.key()] = field.value();
  Say(Side::kReal, draft, "gps", fields, "edge");
  return speech_.voice.ToTwin(draft, "gps", Qos::k0);
}

Publication Poses::LatePosition() {
  Draft draft = speech_.voice.BeginLate(Speaker::kDriver, "edge");
  const js::object place = Place();
  draft.body["position"] = place;
  speech_.account.LateLive(Side::kReal, "position", AsShown(draft, place, "edge"));
  speech_.account.SignOfLife(Side::kReal, speech_.voice.now_us());
  return speech_.voice.ToTwin(draft, "position", Qos::k0);
}

Publication Poses::WantedPosition() {
  Draft draft = speech_.voice.Begin(Speaker::kViewer, "edit");
  draft.body["position"] = Place();
  return speech_.voice.ToTwin(draft, "position", Qos::k0);
}

}  // namespace uplink::synthetic
