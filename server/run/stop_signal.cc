#include "server/run/stop_signal.h"

#include <cstdlib>

namespace uplink::run {

void StopSignal::OnSignal(int signal) {
  if (stopping_) {
    logger_.Warn("stopped_at_once", {{"signal", signal}});
    logger_.Flush();
    std::_Exit(1);
  }
  stopping_ = true;
  if (!started_.load()) {
    tell_stopped_(signal);
    logger_.Flush();
    std::_Exit(0);
  }
  // Whatever failed has asked already.
  if (!failed_.load()) stop_.release();
}

void StopSignal::OnFailure() {
  if (failed_.exchange(true) || stopping_) return;
  stop_.release();
}

}  // namespace uplink::run
