#include "server/http/event_loop.h"

#include <exception>
#include <utility>

#include <boost/asio/post.hpp>
#include <pthread.h>

#include "server/http/asio_context.h"

namespace uplink::http {
namespace {

namespace asio = boost::asio;

void RunAndRepeat(EventLoop::Context::Repeated& repeated) {
  repeated.job();
  repeated.timer.expires_after(repeated.interval);
  repeated.timer.async_wait([&repeated](const boost::system::error_code& error) {
    if (!error) RunAndRepeat(repeated);
  });
}

void Await(EventLoop::Context::Signals& signals) {
  signals.set.async_wait([&signals](const boost::system::error_code& error, int signal) {
    if (error) return;
    signals.job(signal);
    Await(signals);
  });
}

}  // namespace

EventLoop::EventLoop(const log::Logger& logger)
    : logger_(logger), context_(std::make_unique<Context>()) {}

EventLoop::~EventLoop() { Stop(); }

void EventLoop::Every(milliseconds interval, std::function<void()> job) {
  auto& repeated =
      *context_->repeated.emplace_back(std::make_unique<Context::Repeated>(context_->io));
  repeated.interval = interval;
  repeated.job = std::move(job);
  asio::post(context_->io, [&repeated] { RunAndRepeat(repeated); });
}

void EventLoop::OnSignals(const std::vector<int>& signals, std::function<void(int)> job) {
  auto& watched = *context_->signals.emplace_back(std::make_unique<Context::Signals>(context_->io));
  watched.job = std::move(job);
  for (const int signal : signals) watched.set.add(signal);
  Await(watched);
}

void EventLoop::Post(std::function<void()> job) { asio::post(context_->io, std::move(job)); }

void EventLoop::Start() {
  context_->thread = std::jthread([this] { Run(); });
  pthread_setname_np(context_->thread.native_handle(), "io");
}

void EventLoop::Stop() {
  context_->io.stop();
  if (context_->thread.joinable()) context_->thread.join();
}

void EventLoop::Run() {
  // A foreign exception ends the one handler that threw it; the loop goes on.
  while (!context_->io.stopped()) {
    try {
      context_->io.run();
    } catch (const std::exception& error) {
      logger_.Error("io_handler_failed", {{"error", error.what()}});
    }
  }
}

}  // namespace uplink::http
