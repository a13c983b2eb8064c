#include "server/broker/outcome.h"

namespace uplink::broker {

Became BecameOf(cyberwave::Outcome outcome) {
  switch (outcome) {
    case cyberwave::Outcome::kApplied:
      return Became::kApplied;
    case cyberwave::Outcome::kSuperseded:
      return Became::kSuperseded;
    case cyberwave::Outcome::kObserved:
      return Became::kObserved;
    case cyberwave::Outcome::kStored:
      return Became::kStored;
    case cyberwave::Outcome::kRejected:  // it does not come so far
    case cyberwave::Outcome::kIgnored:
      break;
  }
  return Became::kIgnored;
}

void CountOdd(const cyberwave::Judgement& judgement, MessageCounts& counts, BrokerProbe& probe) {
  for (const model::DroppedField& field : judgement.dropped) {
    ++counts.dropped[static_cast<std::size_t>(field.reason)];
  }
  for (const model::UntoldFields& fields : judgement.untold) {
    counts.dropped[static_cast<std::size_t>(fields.reason)] += fields.fields;
  }
  if (judgement.times_unknown > 0) probe.times_unknown.Add(judgement.times_unknown);
  if (judgement.control_characters > 0) probe.control_characters.Add(judgement.control_characters);
}

}  // namespace uplink::broker
