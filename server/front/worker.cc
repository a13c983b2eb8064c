#include "server/front/worker.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pthread.h>

#include "server/transport/drain.h"

namespace uplink::front {

Worker::Worker(const Setup& setup, const RelayContext& relay, transport::Gate& gate,
               const transport::MethodsMaker& make_methods, const ServedContext& tls,
               DoorBook& book, Unfinished& unfinished)
    : setup_(setup),
      tls_(tls),
      thread_state_(relay, gate, make_methods, *this, book, unfinished),
      loop_({.timer =
                 [this] {
                   thread_state_.clock.Advance();
                   RunTimers();
                 },
             .after = [this] { SetTimer(); }}) {}

Worker::~Worker() { Stop(); }

void Worker::Start() {
  thread_ = std::jthread([this] { Run(); });
}

void Worker::Run() {
  const std::string name = fmt::format("{}-{}", setup_.name, setup_.index);
  ::pthread_setname_np(::pthread_self(), name.c_str());
  loop_.Run();
}

void Worker::Post(std::function<void()> work) {
  loop_.Post([this, work = std::move(work)] {
    thread_state_.clock.Advance();
    work();
  });
}

void Worker::Adopt(std::uint64_t id, IncomingConnection incoming) {
  load_.fetch_add(1, std::memory_order_relaxed);
  // A function may be copied, and a descriptor has one owner.
  auto shared = std::make_shared<IncomingConnection>(std::move(incoming));
  Post([this, id, shared = std::move(shared)] {
    arrived_.emplace_back(id, std::move(*shared));
    if (arrived_.size() == 1) Post([this] { BeginNext(); });
  });
}

void Worker::BeginNext() {
  if (arrived_.empty()) return;
  auto [id, incoming] = std::move(arrived_.front());
  arrived_.pop_front();
  Begin(id, std::move(incoming));
  if (!arrived_.empty()) Post([this] { BeginNext(); });
}

void Worker::Begin(std::uint64_t id, IncomingConnection incoming) {
  auto& connection = connections_[id];
  connection = std::make_unique<Connection>(
      thread_state_, loop_, *this,
      Connection::Setup{.id = id,
                        .descriptor = incoming.descriptor.Release(),
                        .origin = std::move(incoming.origin),
                        .tls = tls_.get(),
                        .served = &tls_,
                        .age_max = setup_.connection_age_max,
                        .gateway_streams_max = setup_.gateway_streams_max});
  if (ending_) return connection->Shutdown();
  setup_.handshake_began(id);
  connection->Start();
}

void Worker::CutHandshake(std::uint64_t id) {
  Post([this, id] {
    if (const auto found = connections_.find(id); found != connections_.end()) {
      found->second->CutHandshake();
    }
  });
}

void Worker::Evict(std::uint64_t id) {
  Post([this, id] {
    if (const auto found = connections_.find(id); found != connections_.end()) {
      found->second->Evict();
    }
  });
}

void Worker::LookAtDenied() {
  // A connection that is not here yet looks at its handshake's end, with the list as it is then.
  Post([this] {
    for (const auto& [id, connection] : connections_) connection->LookAtDenied();
  });
}

void Worker::LookAtAuthorities() {
  Post([this] {
    const std::shared_ptr<const TlsContext> now = tls_.get();
    for (const auto& [id, connection] : connections_) connection->LookAtAuthorities(*now);
  });
}

// --- Wakes ---

void Worker::Wake(std::uint64_t call) {
  {
    const std::lock_guard lock(mutex_);
    if (stopped_) return;
    wakes_.insert(call);
    if (std::exchange(wake_posted_, true)) return;
  }
  Post([this] { EmptyInbox(); });
}

void Worker::EmptyInbox() {
  std::unordered_set<std::uint64_t> wakes;
  {
    const std::lock_guard lock(mutex_);
    std::swap(wakes, wakes_);
    wake_posted_ = false;
  }
  thread_state_.relay.probe.wakes_total.Add();
  for (const std::uint64_t id : wakes) {
    const auto found = thread_state_.calls.find(id);
    if (found == thread_state_.calls.end()) continue;
    CallOwner& owner = found->second->owner();
    found->second->OnWake();
    owner.Settle();
  }
}

// --- Timers ---

void Worker::SetTimer() {
  const std::optional<SteadyTime> calls = thread_state_.call_timers.next();
  const std::optional<SteadyTime> connections = thread_state_.connection_timers.next();
  std::optional<SteadyTime> next = calls;
  if (!next || (connections && *connections < *next)) next = connections;
  if (next == timer_at_) return;
  timer_at_ = next;
  if (!next) return loop_.SetTimer(std::nullopt);
  // Our clock is not the system's, so only the distance counts.
  loop_.SetTimer(*next - thread_state_.clock.Steady());
}

void Worker::RunTimers() {
  timer_at_.reset();
  const SteadyTime now = thread_state_.clock.Steady();
  while (const std::optional<std::uint64_t> id = thread_state_.call_timers.PopDue(now)) {
    // The entry of a call is removed with it, so the call exists.
    Call& call = *thread_state_.calls.at(*id);
    CallOwner& owner = call.owner();
    call.OnTimer();
    owner.Settle();
  }
  while (const std::optional<std::uint64_t> id = thread_state_.connection_timers.PopDue(now)) {
    connections_.at(*id)->OnTimer();
  }
}

// --- The end of connections ---

void Worker::OnHandshakeEnded(Connection& connection) { setup_.handshake_ended(connection.id()); }

void Worker::EvictOther(std::uint64_t connection) { setup_.evict(connection); }

void Worker::OnClosed(Connection& connection) {
  closed_.push_back(connection.id());
  if (closed_.size() == 1) Post([this] { Reap(); });
}

void Worker::Reap() {
  const std::vector<std::uint64_t> closed = std::exchange(closed_, {});
  for (const std::uint64_t id : closed) connections_.erase(id);
  load_.fetch_sub(closed.size(), std::memory_order_relaxed);
  EndIfEmpty();
}

void Worker::EndIfEmpty() {
  if (ending_ && connections_.empty()) loop_.Stop();
}

void Worker::Drain(milliseconds grace) {
  Post([this, grace] { BeginDrain(grace); });
}

void Worker::BeginDrain(milliseconds grace) {
  const SteadyTime now = thread_state_.clock.Steady();
  std::vector<Connection*> connections;
  connections.reserve(connections_.size());
  for (const auto& [id, connection] : connections_) connections.push_back(connection.get());
  std::size_t calls = 0;
  for (const Connection* connection : connections) calls += connection->calls();
  const transport::DrainSpread spread(calls, now, grace);
  std::size_t told = 0;
  for (Connection* connection : connections) {
    const std::size_t its_calls = connection->calls();
    connection->Drain(spread, told, now + grace);
    told += its_calls;
  }
}

void Worker::Stop() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  Post([this] { EndAll(); });
  thread_.join();
}

void Worker::EndAll() {
  ending_ = true;
  for (const auto& [id, connection] : connections_) connection->Shutdown();
  EndIfEmpty();
}

}  // namespace uplink::front
