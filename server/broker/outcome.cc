#include "server/broker/outcome.h"

namespace uplink::broker {

metrics::Became BecameOf(cyberwave::Outcome outcome) {
  switch (outcome) {
    case cyberwave::Outcome::kApplied:
      return metrics::Became::kApplied;
    case cyberwave::Outcome::kSuperseded:
      return metrics::Became::kSuperseded;
    case cyberwave::Outcome::kObserved:
      return metrics::Became::kObserved;
    case cyberwave::Outcome::kStored:
      return metrics::Became::kStored;
    case cyberwave::Outcome::kRejected:  // it does not come so far
    case cyberwave::Outcome::kIgnored:
      break;
  }
  return metrics::Became::kIgnored;
}

void CountOdd(const cyberwave::Judgement& judgement, metrics::Ledger& ledger) {
  CountDropped(judgement.dropped, ledger);
  for (const model::UntoldFields& fields : judgement.untold) {
    ledger.CountDropped(metrics::kUnknownKind, fields.reason, fields.fields);
  }
  const metrics::OddCounts odd{.times_unknown = judgement.times_unknown,
                               .control_characters = judgement.control_characters};
  if (odd.any()) ledger.CountOdd(odd);
}

void CountDropped(std::span<const model::DroppedField> dropped, metrics::Ledger& ledger) {
  for (const model::DroppedField& field : dropped) {
    ledger.CountDropped(metrics::kUnknownKind, field.reason);
  }
}

}  // namespace uplink::broker
