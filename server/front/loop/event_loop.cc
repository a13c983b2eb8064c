#include "server/front/loop/event_loop.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <sys/eventfd.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "schema/base/check.h"

namespace uplink::front {
namespace {

int Made(int descriptor) {
  UPLINK_CHECK(descriptor >= 0, "the system has no descriptors for a thread of the relay");
  return descriptor;
}

/// Takes the count out of a timer or an eventfd, so that it is no longer ready.
void Reset(int descriptor) {
  std::uint64_t count = 0;
  // Nothing to take is also fine.
  [[maybe_unused]] const ssize_t taken = ::read(descriptor, &count, sizeof count);
}

epoll_event EventOf(void* owner, bool sending) {
  epoll_event event{};
  event.events = sending ? EPOLLIN | EPOLLOUT : EPOLLIN;
  event.data.ptr = owner;
  return event;
}

}  // namespace

EventLoop::EventLoop(Hooks hooks)
    : hooks_(std::move(hooks)),
      set_(Made(::epoll_create1(EPOLL_CLOEXEC))),
      timer_(Made(::timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK))),
      posts_(Made(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK))) {
  // These two have no owner; their address marks them.
  epoll_event timer = EventOf(const_cast<int*>(&timer_), false);
  Made(::epoll_ctl(set_, EPOLL_CTL_ADD, timer_, &timer));
  epoll_event posts = EventOf(const_cast<int*>(&posts_), false);
  Made(::epoll_ctl(set_, EPOLL_CTL_ADD, posts_, &posts));
}

EventLoop::~EventLoop() {
  ::close(posts_);
  ::close(timer_);
  ::close(set_);
}

void EventLoop::Run() {
  while (!stopped_) {
    const int ready = ::epoll_wait(set_, events_.data(), static_cast<int>(events_.size()), -1);
    const auto count = static_cast<std::size_t>(std::max(ready, 0));
    const std::size_t handshakes = HandleAllButHandshakes(count);
    HandleHandshakes(handshakes, 1 + (count - handshakes) / kEventsPerHandshake);
    // After the events, which may refer to what this destroys.
    if (std::exchange(posts_due_, false)) RunPosted();
    hooks_.after();
  }
}

Turn EventLoop::TurnOf(const epoll_event& event) const {
  if (event.data.ptr == &timer_ || event.data.ptr == &posts_) return Turn::kNow;
  return static_cast<const ReadyOwner*>(event.data.ptr)->turn();
}

std::size_t EventLoop::HandleAllButHandshakes(std::size_t ready) {
  std::size_t handshakes = 0;
  for (std::size_t i = 0; i < ready; ++i) {
    const epoll_event event = events_[i];
    if (TurnOf(event) == Turn::kNow) {
      Handle(event);
    } else {
      events_[handshakes++] = event;
    }
  }
  return handshakes;
}

void EventLoop::HandleHandshakes(std::size_t ready, std::size_t steps) {
  auto end = events_.begin() + static_cast<std::ptrdiff_t>(ready);
  for (; steps > 0 && end != events_.begin(); --steps) {
    auto next = events_.begin();
    if (++handshake_steps_ % kFirstReadyEvery != 0) {
      next = std::min_element(next, end, [this](const epoll_event& left, const epoll_event& right) {
        return TurnOf(left) < TurnOf(right);
      });
    }
    const epoll_event event = *next;
    end = std::move(next + 1, end, next);
    Handle(event);
  }
}

void EventLoop::Handle(const epoll_event& event) {
  if (event.data.ptr == &timer_) {
    Reset(timer_);
    hooks_.timer();
  } else if (event.data.ptr == &posts_) {
    Reset(posts_);
    posts_due_ = true;
  } else {
    static_cast<ReadyOwner*>(event.data.ptr)->OnReady(event.events);
  }
}

void EventLoop::RunPosted() {
  std::vector<std::function<void()>> works;
  {
    const std::lock_guard lock(mutex_);
    std::swap(works, posted_);
  }
  for (const auto& work : works) work();
}

void EventLoop::Post(std::function<void()> work) {
  {
    const std::lock_guard lock(mutex_);
    posted_.push_back(std::move(work));
    if (posted_.size() > 1) return;
  }
  const std::uint64_t one = 1;
  // It fails only if a wake is already pending.
  [[maybe_unused]] const ssize_t written = ::write(posts_, &one, sizeof one);
}

bool EventLoop::Watch(int descriptor, ReadyOwner& owner) {
  epoll_event event = EventOf(&owner, false);
  return ::epoll_ctl(set_, EPOLL_CTL_ADD, descriptor, &event) == 0;
}

void EventLoop::WatchSending(int descriptor, ReadyOwner& owner, bool wanted) {
  epoll_event event = EventOf(&owner, wanted);
  // It was added before, so there is room for it.
  ::epoll_ctl(set_, EPOLL_CTL_MOD, descriptor, &event);
}

void EventLoop::SetTimer(std::optional<SteadyTime::duration> after) {
  itimerspec spec{};
  if (after) {
    // All zeros would mean no timer.
    const auto wait = std::max(*after, SteadyTime::duration(1));
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(wait);
    spec.it_value.tv_sec = seconds.count();
    spec.it_value.tv_nsec = std::chrono::nanoseconds(wait - seconds).count();
  }
  ::timerfd_settime(timer_, 0, &spec, nullptr);
}

}  // namespace uplink::front
