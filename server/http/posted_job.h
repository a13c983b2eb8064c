#pragma once

#include <functional>
#include <optional>

#include "server/http/connection.h"
#include "server/http/routes.h"
#include "server/loop/read_threads.h"

namespace uplink::http {

/// A request's job on a thread, which outlives the connections.
class PostedJob final {
 public:
  /// Posts to the lane's thread; nothing if it takes no more. The lane is not kIo.
  [[nodiscard]] static std::optional<PostedJob> Post(const ConnectionContext& context, Lane lane,
                                                     std::function<void()> run);
  /// Drops the job if it still waits, and with it what it holds.
  void Withdraw() const { thread_->Withdraw(id_); }

 private:
  PostedJob(loop::ReadThreads& thread, loop::JobId id) : thread_(&thread), id_(id) {}

  loop::ReadThreads* thread_;
  loop::JobId id_;
};

}  // namespace uplink::http
