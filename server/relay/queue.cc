#include "server/relay/queue.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pthread.h>

#include "schema/base/check.h"
#include "server/relay/call.h"
#include "server/transport/drain.h"

namespace uplink::relay {

Queue::Queue(std::size_t index, std::unique_ptr<grpc::ServerCompletionQueue> completions,
             RelayService& service, transport::Gate& gate, const transport::RelayContext& relay)
    : index_(index),
      completions_(std::move(completions)),
      service_(service),
      gate_(gate),
      relay_(relay),
      clock_(relay.clock),
      judge_(relay.judge_limits),
      context_{clock_,
               relay.fleet,
               relay.journals,
               relay.session_probe,
               relay.ledgers.NewPage(),
               judge_,
               relay.limits,
               scratch_,
               relay.allowances,
               relay.rejects,
               relay.clock_trust,
               nullptr,
               relay.forwards} {}

Queue::~Queue() {
  UPLINK_CHECK(!thread_.joinable(), "a queue that was started must be closed");
  if (closed_) return;
  // It never started: gRPC wants every queue shut down and emptied.
  completions_->Shutdown();
  void* tag = nullptr;
  bool ok = false;
  while (completions_->Next(&tag, &ok)) {
  }
}

void Queue::Start() {
  thread_ = std::jthread([this] { Run(); });
}

template <typename Change>
void Queue::Post(const Change& change) {
  {
    const std::lock_guard lock(mutex_);
    if (closed_) return;
    change(inbox_);
    if (alarm_pending_) return;
    alarm_pending_ = true;
  }
  // The queue does not close while the alarm is pending, so this needs no lock.
  alarm_.Set(completions_.get(), gpr_inf_past(GPR_CLOCK_MONOTONIC), &inbox_tag_);
}

void Queue::Wake(std::uint64_t stream) {
  Post([stream](Inbox& inbox) { inbox.wakes.insert(stream); });
}

void Queue::Drain(milliseconds grace) {
  Post([grace](Inbox& inbox) { inbox.drain = grace; });
}

void Queue::Close() {
  if (!thread_.joinable()) return;
  Post([](Inbox& inbox) { inbox.close = true; });
  thread_.join();
}

void Queue::Run() {
  const std::string name = fmt::format("relay-{}", index_);
  ::pthread_setname_np(::pthread_self(), name.c_str());
  for (std::size_t i = 0; i < kOffersMax; ++i) Offer();
  void* tag = nullptr;
  bool ok = false;
  while (true) {
    switch (completions_->AsyncNext(&tag, &ok, NextDeadline())) {
      case grpc::CompletionQueue::SHUTDOWN:
        return;
      case grpc::CompletionQueue::GOT_EVENT:
        clock_.Advance();
        static_cast<Tag*>(tag)->Proceed(ok);
        break;
      case grpc::CompletionQueue::TIMEOUT:
        clock_.Advance();
        if (closing_ && CloseIfDone()) completions_->Shutdown();
        break;
    }
    RunTimers();
  }
}

gpr_timespec Queue::NextDeadline() {
  // Closing: look at each event that is there already, then shut down.
  if (closing_ && calls_.empty()) return gpr_inf_past(GPR_CLOCK_MONOTONIC);
  const std::optional<SteadyTime> next = timers_.next();
  if (next == next_timer_) return next_deadline_;
  next_timer_ = next;
  next_deadline_ = gpr_inf_future(GPR_CLOCK_MONOTONIC);
  if (!next) return next_deadline_;
  // Our clock is not gRPC's, so only the distance counts.
  const auto wait = std::max(*next - now(), SteadyTime::duration(0));
  const auto micros = std::chrono::ceil<std::chrono::microseconds>(wait).count();
  next_deadline_ =
      gpr_time_add(gpr_now(GPR_CLOCK_MONOTONIC), gpr_time_from_micros(micros, GPR_TIMESPAN));
  return next_deadline_;
}

void Queue::EmptyInbox() {
  Inbox inbox;
  {
    const std::lock_guard lock(mutex_);
    std::swap(inbox, inbox_);
    alarm_pending_ = false;
  }
  relay_.probe.wakes_total.Add();
  for (const std::uint64_t id : inbox.wakes) {
    if (const auto found = calls_.find(id); found != calls_.end()) found->second->OnWake();
  }
  if (inbox.drain) BeginDrain(*inbox.drain);
  closing_ = closing_ || inbox.close;
}

void Queue::RunTimers() {
  while (const std::optional<std::uint64_t> id = timers_.PopDue(now())) {
    // An entry is taken out when its call retires, so the call is there.
    calls_.at(*id)->OnTimer();
  }
}

void Queue::BeginDrain(milliseconds grace) {
  std::vector<Call*> streams;
  for (const auto& [id, call] : calls_) {
    if (call->has_session()) streams.push_back(call.get());
  }
  const transport::DrainSpread spread(streams.size(), now(), grace);
  for (std::size_t i = 0; i < streams.size(); ++i) {
    streams[i]->DrainAt(spread.At(i), now() + grace);
  }
}

bool Queue::CloseIfDone() {
  if (!calls_.empty()) return false;
  const std::lock_guard lock(mutex_);
  if (closed_ || alarm_pending_) return false;
  closed_ = true;
  return true;
}

void Queue::Offer() {
  const std::uint64_t id = next_id_++;
  Call& call = *calls_.emplace(id, std::make_unique<Call>(*this, id)).first->second;
  call.Offer();
}

void Queue::Retire(Call& call) { calls_.erase(call.id()); }

void Queue::CallAt(std::uint64_t id, transport::Timers::Slot& slot, SteadyTime deadline) {
  timers_.Want(id, slot, deadline, now());
}

}  // namespace uplink::relay
