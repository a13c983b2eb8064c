#pragma once

#include "schema/base/clock.h"
#include "schema/cyberwave/judge.h"
#include "server/broker/limited_log.h"
#include "server/broker/limits.h"
#include "server/limits/keyed_buckets.h"
#include "server/mqtt/packets.h"

namespace uplink::broker {

/// Judges what a broker delivers. Of one id at QoS 0 it reads at most limits::PolicyId::kBytesOfId:
/// reading a large payload takes longer than sending it, and meanwhile the broker drops other
/// messages. At QoS 1 our acks slow publishers down.
///
/// Thread:  confined to its owner's.
class PayloadJudge final {
 public:
  /// Both outlive it.
  PayloadJudge(const cyberwave::JudgeTerms& terms, LimitedLog& limited_log)
      : terms_(terms), limited_log_(limited_log) {}

  struct Judged {
    cyberwave::Judgement judgement;
    /// Its id sends too much at QoS 0: only its topic was judged.
    bool over_budget = false;
  };
  [[nodiscard]] Judged Judge(const mqtt::Publish& publish, SteadyTime arrived);

 private:
  const cyberwave::JudgeTerms& terms_;
  LimitedLog& limited_log_;
  limits::KeyedBuckets bytes_{limits::PolicyOf(limits::PolicyId::kBytesOfId)};
};

}  // namespace uplink::broker
