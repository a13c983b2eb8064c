#include "server/broker/payload_judge.h"

#include <utility>

namespace uplink::broker {

PayloadJudge::Judged PayloadJudge::Judge(const mqtt::Publish& publish, SteadyTime arrived) {
  if (!publish.payload) {
    return {.judgement = cyberwave::JudgeUnread(publish.topic, publish.payload_bytes, terms_)};
  }
  auto judged = cyberwave::JudgeTopic(publish.topic, publish.payload_bytes, terms_);
  if (!judged.decided && publish.id == 0 && publish.payload_bytes >= kBudgetedBytesMin) {
    if (!limited_log_.Passes(bytes_, judged.judgement.topic, publish.payload_bytes, arrived)) {
      return {.judgement = std::move(judged.judgement), .over_budget = true};
    }
  }
  return {.judgement = cyberwave::JudgePayload(std::move(judged), *publish.payload, terms_)};
}

}  // namespace uplink::broker
