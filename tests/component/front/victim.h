#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "tests/component/front/front_world.h"

namespace uplink::testing {

/// An honest robot that streams durable messages: each batch once the one before was acked.
///
/// Thread: its own; the rest is the test's.
class Victim final {
 public:
  Victim(const RelayWorld& world, int number);
  /// Ends it.
  ~Victim();
  Victim(const Victim&) = delete;
  Victim& operator=(const Victim&) = delete;

  /// Waits until more of its messages were acked than were when this was called.
  [[nodiscard]] bool GoesOn() const;
  /// Sends no more, and ends the call: true if every message was acked and the call ended well.
  [[nodiscard]] bool Finish();
  /// Messages that were sent and acked.
  [[nodiscard]] model::Seq acked() const { return acked_.load(); }
  [[nodiscard]] std::string ruri() const { return ruri_; }
  [[nodiscard]] static model::SessionId session() { return SessionOf(1); }

 private:
  void Run(const std::shared_ptr<grpc::Channel>& channel);
  /// A pause between batches; false once it is to end.
  bool Pause();

  const std::string ruri_;
  std::atomic<model::Seq> acked_{0};
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ends_ = false;
  /// Written by its thread, read once that has ended.
  bool well_ = false;
  std::jthread thread_;
};

}  // namespace uplink::testing
