#pragma once

#include "schema/base/check.h"
#include "schema/model/ids.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::fuzz {

/// What the frames that a server sends on one stream keep to, whatever its robot does. Aborts if
/// they do not. A value.
class FrameOrder final {
 public:
  void Add(const v1::RelayResponse& frame) {
    UPLINK_CHECK(welcomed_ || frame.has_welcome(), "Welcome comes first");
    UPLINK_CHECK(!welcomed_ || !frame.has_welcome(), "Welcome comes once");
    welcomed_ = true;
    if (frame.has_ack()) {
      UPLINK_CHECK(frame.ack().through_seq() >= through_, "through_seq only grows");
      UPLINK_CHECK(frame.ack().judged_seq() >= judged_, "judged_seq only grows");
      through_ = frame.ack().through_seq();
      judged_ = frame.ack().judged_seq();
      UPLINK_CHECK(through_ <= judged_, "what is settled was judged");
    }
    if (frame.has_reject()) {
      UPLINK_CHECK(frame.reject().seq() > through_, "a Reject comes before the Ack that covers it");
    }
  }

  /// The highest number that was judged.
  [[nodiscard]] model::Seq judged() const { return judged_; }

 private:
  bool welcomed_ = false;
  model::Seq through_ = 0;
  model::Seq judged_ = 0;
};

}  // namespace uplink::fuzz
