#pragma once

#include "schema/base/clock.h"
#include "schema/cyberwave/judge.h"
#include "server/broker/limited_log.h"
#include "server/broker/limits.h"
#include "server/limits/keyed_buckets.h"
#include "server/mqtt/packets.h"

namespace uplink::broker {

/// Judges what a broker delivers, and looks into no more bytes of one id at QoS 0 than
/// limits::PolicyId::kBytesOfId.
/// To read a large payload takes longer than its publisher needs to send it, and meanwhile the
/// broker drops what others say. At QoS 1 our acks hold publishers back.
///
/// Thread:  confined to its owner's.
class PayloadJudge final {
 public:
  /// Both outlive it.
  PayloadJudge(const cyberwave::JudgeTerms& terms, LimitedLog& limited_log)
      : terms_(terms), limited_log_(limited_log) {}

  struct Judged {
    cyberwave::Judgement judgement;
    /// Its id sends too much at QoS 0: judged is its topic alone.
    bool over_budget = false;
  };
  [[nodiscard]] Judged Judge(const mqtt::Publish& publish, SteadyTime arrived);

 private:
  const cyberwave::JudgeTerms& terms_;
  LimitedLog& limited_log_;
  limits::KeyedBuckets bytes_{limits::PolicyOf(limits::PolicyId::kBytesOfId)};
};

}  // namespace uplink::broker
