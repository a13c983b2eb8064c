#include "server/loop/event_loop.h"

#include <atomic>
#include <future>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <signal.h>

namespace uplink::loop {
namespace {

class Lines final : public log::LineSink {
 public:
  explicit Lines(std::promise<std::string>& first) : first_(first) {}
  void Write(log::Level /*level*/, std::string_view line) override {
    first_.set_value(std::string(line));
  }

 private:
  std::promise<std::string>& first_;
};

class EventLoopTest : public ::testing::Test {
 protected:
  std::promise<std::string> line_;
  SystemClock clock_;
  log::Logger logger_{std::make_unique<Lines>(line_), clock_, log::Format::kText,
                      log::Level::kInfo};
};

TEST_F(EventLoopTest, RepeatsAJobFromTheStart) {
  EventLoop loop(logger_);
  std::promise<void> thrice;
  int runs = 0;
  loop.Every(milliseconds(1), [&] {
    if (++runs == 3) thrice.set_value();
  });
  loop.Start();
  thrice.get_future().wait();
}

TEST_F(EventLoopTest, TellsOfSignalsEachTime) {
  EventLoop loop(logger_);
  std::promise<int> first;
  std::promise<int> second;
  int count = 0;
  loop.OnSignals({SIGUSR1, SIGUSR2},
                 [&](int signal) { (++count == 1 ? first : second).set_value(signal); });
  loop.Start();
  raise(SIGUSR1);
  EXPECT_EQ(first.get_future().get(), SIGUSR1);
  raise(SIGUSR2);
  EXPECT_EQ(second.get_future().get(), SIGUSR2);
}

TEST_F(EventLoopTest, AnExceptionEndsOneJobAndIsLogged) {
  EventLoop loop(logger_);
  std::promise<void> after;
  loop.Post([] { static_cast<void>(std::string().at(1)); });
  loop.Post([&] { after.set_value(); });
  loop.Start();
  after.get_future().wait();
  EXPECT_NE(line_.get_future().get().find("io_handler_failed"), std::string::npos);
}

TEST_F(EventLoopTest, RunsJobsInTheOrderInWhichTheyWerePosted) {
  EventLoop loop(logger_);
  std::vector<std::string> ran;
  std::promise<void> last;
  loop.Post([&] {
    loop.Post([&] { ran.emplace_back("its own"); });
    std::jthread([&] {
      loop.Post([&] {
        ran.emplace_back("another thread's");
        last.set_value();
      });
    }).join();
  });
  loop.Start();
  last.get_future().wait();
  loop.Stop();
  EXPECT_EQ(ran, (std::vector<std::string>{"its own", "another thread's"}));
}

TEST_F(EventLoopTest, StopsWithJobsStillQueued) {
  EventLoop loop(logger_);
  loop.Every(std::chrono::hours(1), [] {});
  loop.Start();
  loop.Stop();
  loop.Stop();
  loop.Post([] { FAIL() << "ran after Stop"; });
}

}  // namespace
}  // namespace uplink::loop
