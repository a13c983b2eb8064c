#pragma once

#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>

#include "server/http/event_loop.h"

namespace uplink::http {

struct EventLoop::Context {
  struct Repeated {
    explicit Repeated(boost::asio::io_context& io) : timer(io) {}
    boost::asio::steady_timer timer;
    milliseconds interval{0};
    std::function<void()> job;
  };
  struct Signals {
    explicit Signals(boost::asio::io_context& io) : set(io) {}
    boost::asio::signal_set set;
    std::function<void(int)> job;
  };

  /// One thread runs it: no locks inside.
  boost::asio::io_context io{1};
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work{io.get_executor()};
  std::vector<std::unique_ptr<Repeated>> repeated;
  std::vector<std::unique_ptr<Signals>> signals;
  std::jthread thread;
};

}  // namespace uplink::http
