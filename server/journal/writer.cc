#include "server/journal/writer.h"

#include <utility>

#include "server/journal/turns.h"

namespace uplink::journal {

JournalWriter::JournalWriter(Journal& journal, const BackoffLimits& backoff,
                             std::function<std::uint64_t()> random)
    : turns_(journal.turns()),
      backoff_(backoff),
      random_(std::move(random)),
      rounds_("journal", [this](const std::stop_token& stop) { return Round(stop); }) {
  rounds_.Start();
}

loop::Next JournalWriter::Round(const std::stop_token& stop) {
  switch (turns_.Advance()) {
    case Step::kIdle:
      turns_.WaitForWork(stop);
      break;
    case Step::kWorked:
      backoff_.Reset();
      break;
    case Step::kFailed:
      return {.within = backoff_.Next(random_())};
  }
  return {};
}

}  // namespace uplink::journal
