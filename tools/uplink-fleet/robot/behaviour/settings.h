#pragma once

#include "schema/model/capabilities.h"
#include "tools/uplink-fleet/robot/behaviour/facts.h"
#include "tools/uplink-fleet/robot/behaviour/seeded.h"

namespace uplink::synthetic {

/// What the robot can do, and its settings. Both are reported at the start. A setting changes now
/// and then, within what the capabilities declare, and all of them are reported again.
class Settings final {
 public:
  explicit Settings(Seeded random);

  void Advance(const Moment& moment, Outbox& out);
  // As they are now, when the server asks for them.
  [[nodiscard]] const model::UiCapabilities& capabilities() const { return capabilities_; }
  [[nodiscard]] const model::CurrentSettings& current() const { return current_; }

 private:
  void ChangeOne();

  Seeded random_;
  model::UiCapabilities capabilities_;
  model::CurrentSettings current_;
  bool told_ = false;
  Every change_;
};

}  // namespace uplink::synthetic
