#include "server/run/start.h"

namespace uplink::run {

absl::Status Start(const StartSteps& steps) {
  steps.read_robots();
  steps.start_writers();
  if (absl::Status listens = steps.listen_for_robots(); !listens.ok()) return listens;
  steps.answer_http();
  steps.tell_ready();
  steps.begin_work();
  return absl::OkStatus();
}

void Stop(const StopSteps& steps) {
  steps.stop_relay();
  steps.stop_writers();
  steps.stop_loop();
  steps.end_readers();
}

}  // namespace uplink::run
