#pragma once

#include <cstdint>
#include <deque>
#include <string>

#include "schema/model/spatial.h"
#include "tools/uplink-fleet/robot/behaviour/facts.h"
#include "tools/uplink-fleet/robot/behaviour/missions.h"
#include "tools/uplink-fleet/robot/behaviour/route.h"
#include "tools/uplink-fleet/robot/behaviour/seeded.h"

namespace uplink::synthetic {

/// The areas that a robot reports: what each mission has covered grows as it drives and is taken
/// back two missions later; the path that it plans; hazards that expire; and one of each of the
/// other geometries, revised now and then.
class Coverage final {
 public:
  /// Ids begin with `mark`.
  Coverage(Seeded random, std::string mark) : random_(random), mark_(std::move(mark)) {}

  void Advance(const Moment& moment, const Facts& facts, const Missions& missions,
               const Route& route, Outbox& out);

 private:
  void Follow(const Facts& facts);
  void Covered(const Moment& moment, Outbox& out);
  void BeginMission(const Moment& moment, const Route& route, Outbox& out);
  void Hazard(const Moment& moment, const Facts& facts, Outbox& out);
  void Fixed(const Moment& moment, const Route& route, Outbox& out);
  [[nodiscard]] model::ReportedShape Shape(std::string id, std::string name,
                                           model::ReportedLayerRole role, model::ShapeData data);

  Seeded random_;
  std::string mark_;
  std::uint32_t run_ = 0;
  /// Where the robot has been in this mission, a few metres apart.
  model::Positions track_;
  model::GeoPoint2 last_;
  bool grown_ = false;
  std::deque<std::string> kept_;
  std::uint32_t revision_ = 0;
  std::uint32_t hazards_ = 0;
  Every covered_{3, 1.5};
  Every hazard_{12, 4};
  Every fixed_{20, 2};
};

}  // namespace uplink::synthetic
