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
/// negative time counts as zero. A value.
struct Next {
  /// The next round begins after this time at the latest.
  SteadyTime::duration within{0};
  /// A wake makes it begin sooner, but not before this time.
  SteadyTime::duration not_before{0};
};

/// A thread that repeats one job, round by round.
///
/// Its owner declares it last, so that the thread ends before the members that the rounds use.
/// Thread: Wake from any; the rest by its owner.
class Rounds final {
 public:
  /// A round that waits for something itself must end that wait at `stop`. It does not throw.
  using Round = std::function<Next(const std::stop_token& stop)>;

  /// `name`: the thread's, at most 15 bytes.
  Rounds(std::string name, Round round);
  ~Rounds() { Stop(); }
  Rounds(const Rounds&) = delete;
  Rounds& operator=(const Rounds&) = delete;

  /// Begins the first round at once.
  void Start();
  /// Asks the thread to end after the round under way, and does not wait for that.
  void RequestStop() { thread_.request_stop(); }
  /// The same, and waits for it. Idempotent.
  void Stop();
  /// Makes a round begin after this call, even if one is under way or the thread has not started.
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
