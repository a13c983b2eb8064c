#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "schema/model/spatial.h"
#include "tools/uplink-fleet/robot/behaviour/facts.h"
#include "tools/uplink-fleet/robot/behaviour/seeded.h"

namespace uplink::synthetic {

/// What a robot sees around it: a few objects that come, move straight on, and go. Each report
/// names an expiry some seconds ahead; half of those that go are deleted, the others expire. A
/// marker that names no expiry stays.
class Objects final {
 public:
  /// Ids begin with `mark`.
  Objects(Seeded random, std::string mark) : random_(random), mark_(std::move(mark)) {}

  void Advance(const Moment& moment, const Facts& facts, Outbox& out);

 private:
  struct Seen {
    model::Object object;
    double left_s = 0;
    Every report{2, 0};
  };

  void Begin(Seen& seen, const Moment& moment, const Facts& facts);
  void Marker(const Moment& moment, const Facts& facts, Outbox& out);

  Seeded random_;
  std::string mark_;
  std::array<Seen, 3> seen_;
  std::uint32_t objects_ = 0;
  bool marked_ = false;
};

}  // namespace uplink::synthetic
