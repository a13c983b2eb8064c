#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "schema/model/spatial.h"
#include "tools/uplink-fleet/robot/behaviour/facts.h"
#include "tools/uplink-fleet/robot/behaviour/seeded.h"

namespace uplink::synthetic {

/// What a robot shares with the others, in all the ways in which that can end: a hazard and an
/// object whose ids are those of every robot of the run are revised, kept to the robot, shared
/// again, and deleted; short-lived ones expire, some after they were reported once more.
class Sharing final {
 public:
  /// The ids of its own begin with `mark`, those that all robots use with `run`.
  Sharing(Seeded random, std::string mark, std::string run)
      : random_(random), mark_(std::move(mark)), run_(std::move(run)) {}

  void Advance(const Moment& moment, const Facts& facts, Outbox& out);

 private:
  [[nodiscard]] model::ScopeType NextScope();
  void Hazard(const Facts& facts, Outbox& out);
  void Thing(const Moment& moment, const Facts& facts, Outbox& out);
  void Flash(const Moment& moment, const Facts& facts, Outbox& out);
  void TellAgain(const Moment& moment, Outbox& out);

  Seeded random_;
  std::string mark_;
  std::string run_;
  std::uint32_t revision_ = 0;
  std::uint32_t flashes_ = 0;
  bool hazard_ = false;
  bool thing_ = false;
  std::optional<model::ReportedShape> flash_;
  Every common_{10, 1};
  Every flash_every_{20, 3};
};

}  // namespace uplink::synthetic
