#include "server/loop/event_loop.h"

#include <exception>
#include <memory>
#include <thread>
#include <utility>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <pthread.h>

namespace uplink::loop {
namespace {

namespace asio = boost::asio;

struct Repeated {
  explicit Repeated(asio::io_context& io) : timer(io) {}
  asio::steady_timer timer;
  milliseconds interval{0};
  std::function<void()> job;
};

struct Signals {
  explicit Signals(asio::io_context& io) : set(io) {}
  asio::signal_set set;
  std::function<void(int)> job;
};

void RunAndRepeat(Repeated& repeated) {
  repeated.job();
  repeated.timer.expires_after(repeated.interval);
  repeated.timer.async_wait([&repeated](const boost::system::error_code& error) {
    if (!error) RunAndRepeat(repeated);
  });
}

void Await(Signals& signals) {
  signals.set.async_wait([&signals](const boost::system::error_code& error, int signal) {
    if (error) return;
    signals.job(signal);
    Await(signals);
  });
}

}  // namespace

struct EventLoop::Context {
  /// Asio must not know that one thread runs it. Otherwise it would keep jobs that this thread
  /// posts apart until the job under way has ended, and jobs of other threads would overtake them.
  asio::io_context io;
  asio::executor_work_guard<asio::io_context::executor_type> work{io.get_executor()};
  std::vector<std::unique_ptr<Repeated>> repeated;
  std::vector<std::unique_ptr<Signals>> signals;
  std::jthread thread;
};

EventLoop::EventLoop(const log::Logger& logger, const char* name)
    : logger_(logger), name_(name), context_(std::make_unique<Context>()) {}

EventLoop::~EventLoop() { Stop(); }

void EventLoop::Every(milliseconds interval, std::function<void()> job) {
  auto& repeated = *context_->repeated.emplace_back(std::make_unique<Repeated>(context_->io));
  repeated.interval = interval;
  repeated.job = std::move(job);
  asio::post(context_->io, [&repeated] { RunAndRepeat(repeated); });
}

void EventLoop::OnSignals(const std::vector<int>& signals, std::function<void(int)> job) {
  auto& watched = *context_->signals.emplace_back(std::make_unique<Signals>(context_->io));
  watched.job = std::move(job);
  for (const int signal : signals) watched.set.add(signal);
  Await(watched);
}

void EventLoop::Post(std::function<void()> job) { asio::post(context_->io, std::move(job)); }

asio::io_context& EventLoop::io() { return context_->io; }

void EventLoop::Start() {
  context_->thread = std::jthread([this] { Run(); });
  pthread_setname_np(context_->thread.native_handle(), name_);
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

}  // namespace uplink::loop
