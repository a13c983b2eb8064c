#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include "schema/base/clock.h"

namespace uplink::loop {

/// When the next round begins, counted from the end of the last one: at once, unless set. A
/// negative time is none. A value.
struct Next {
  /// At the latest after so long.
  SteadyTime::duration within{0};
  /// A wake makes it come sooner than that, but not before so long.
  SteadyTime::duration not_before{0};
};

/// A thread of its own that does one thing again and again, a round at a time.
///
/// Its owner declares it last, so that the thread ends before what the rounds use.
/// Thread: Wake from any; the rest by its owner.
class Rounds final {
 public:
  /// `stop` ends what a round waits for by itself. It does not throw.
  using Round = std::function<Next(const std::stop_token& stop)>;

  /// `name` is that of the thread, of at most 15 bytes.
  Rounds(std::string name, Round round);
  ~Rounds() { Stop(); }
  Rounds(const Rounds&) = delete;
  Rounds& operator=(const Rounds&) = delete;

  /// Begins the first round at once.
  void Start();
  /// Asks the thread to end after the round under way, without waiting for it.
  void RequestStop() { thread_.request_stop(); }
  /// The same, and waits for it. Idempotent.
  void Stop();
  /// Makes a round begin after this call, also where one is under way or the thread has not
  /// started.
  void Wake();

 private:
  void Run(const std::stop_token& stop);

  const std::string name_;
  const Round round_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  bool woken_ = false;
  std::jthread thread_;
};

}  // namespace uplink::loop
