#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "tools/uplink-fleet/robot/behaviour/facts.h"
#include "tools/uplink-fleet/robot/behaviour/route.h"
#include "tools/uplink-fleet/robot/behaviour/seeded.h"

namespace uplink::synthetic {

/// What the robot is made of: agent info, readings, two computers, counts of use, two tanks that
/// empty while it works and are filled, and two zones whose rules it applies.
class Equipment final {
 public:
  explicit Equipment(Seeded random);

  void Advance(const Moment& moment, const Facts& facts, const Route& route, Outbox& out);
  /// One of each live message, every key: what the server must show from then on.
  void All(const Moment& moment, const Facts& facts, const Route& route, Outbox& out);
  /// What the robot runs.
  void Info(Outbox& out);

 private:
  static constexpr std::size_t kDevices = 2;
  static constexpr std::size_t kTanks = 2;
  static constexpr std::size_t kZones = 2;

  void Extras(const Moment& moment, const Facts& facts, Outbox& out);
  void Health(const Moment& moment, std::size_t device, Outbox& out);
  void Usage(const Moment& moment, const Facts& facts, Outbox& out);
  void Consumable(const Moment& moment, std::size_t tank, Outbox& out);
  void Directive(const Moment& moment, const Facts& facts, const Route& route, std::size_t zone,
                 Outbox& out);

  Seeded random_;
  double uptime_s_;
  double deck_c_ = 25;
  std::array<double, kTanks> level_pct_;
  std::uint64_t turn_ = 0;
  Every extras_;
  Every health_;
  Every usage_;
  Every consumable_;
  Every directive_;
  Every info_{60, 0};
};

}  // namespace uplink::synthetic
