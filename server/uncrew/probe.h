#pragma once

#include <array>
#include <cstddef>

#include "metrics/cells.h"
#include "schema/model/uncrew/types.h"
#include "server/uncrew/answer.h"

namespace uplink::uncrew {

/// Answer times, by how a sample was settled.
struct AnswerSeconds {
  metrics::LatencyDistribution live{metrics::kLatencyBoundsSeconds};
  metrics::LatencyDistribution durable{metrics::kLatencyBoundsSeconds};
};

/// Counts of drones' calls beside the ledger. Thread-safe; one for all threads.
struct AvatarProbe {
  /// By type (the first is unused) and Outcome.
  std::array<std::array<metrics::CoreCell, kOutcomeWords.size()>,
             model::uncrew::kTypeRows.size() + 1>
      publishes_total;
  AnswerSeconds answer_seconds;
};

}  // namespace uplink::uncrew
