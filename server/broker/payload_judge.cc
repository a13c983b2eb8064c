#include "server/broker/payload_judge.h"

#include <utility>

namespace uplink::broker {

PayloadJudge::Judged PayloadJudge::Judge(const mqtt::Publish& publish, SteadyTime arrived) {
  if (!publish.payload) {
    return {.judgement = cyberwave::JudgeUnread(publish.topic, publish.payload_bytes, terms_)};
  }
  auto judged = cyberwave::JudgeTopic(publish.topic, publish.payload_bytes, terms_);
  if (!judged.decided && publish.id == 0) {
    using enum ByteBudgets::Answer;
    const cyberwave::Topic& topic = judged.judgement.topic;
    const ByteBudgets::Answer answer = budgets_.Take(topic, publish.payload_bytes, arrived);
    if (answer == kOverAndTell) limited_log_.Tell(topic);
    if (answer != kPasses) return {.judgement = std::move(judged.judgement), .over_budget = true};
  }
  return {.judgement = cyberwave::JudgePayload(std::move(judged), *publish.payload, terms_)};
}

}  // namespace uplink::broker
