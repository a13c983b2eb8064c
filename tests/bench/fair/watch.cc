#include "tests/bench/fair/watch.h"

#include <algorithm>
#include <condition_variable>
#include <utility>

#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>

#include "tests/bench/page.h"

namespace uplink::bench {
namespace {

constexpr milliseconds kLookEvery{500};
/// The robots whose waits are measured come first.
constexpr int kNice = 19;

}  // namespace

Watch::Watch(std::uint16_t http_port, std::string bad_ruri, const Misdeed& misdeed)
    : bad_ruri_(std::move(bad_ruri)),
      misdeed_(misdeed),
      client_(fmt::format("127.0.0.1:{}", http_port)),
      thread_([this](const std::stop_token& stop) { Run(stop); }) {}

void Watch::Enter(Window window) {
  const std::lock_guard lock(mutex_);
  window_ = window;
}

WatchFigures Watch::Of(Window window) const {
  const std::lock_guard lock(mutex_);
  return figures_.at(static_cast<std::size_t>(window));
}

WatchFigures& Watch::Present() { return figures_.at(static_cast<std::size_t>(window_)); }

void Watch::Run(const std::stop_token& stop) {
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);
  std::mutex mutex;
  std::condition_variable_any never;
  while (!stop.stop_requested()) {
    Look(stop);
    std::unique_lock lock(mutex);
    never.wait_for(lock, stop, kLookEvery, [] { return false; });
  }
}

void Watch::Look(const std::stop_token& stop) {
  Scrape();
  if (stop.stop_requested()) return;
  LookForPresence("unknown", &WatchFigures::unknown);
  LookForPresence("offline", &WatchFigures::offline);
  if (misdeed_.robots_scraped) static_cast<void>(Get("/metrics/robots"));
  // It is 404 until the robot is there.
  if (misdeed_.page_looked_at) {
    static_cast<void>(client_.Get("/api/v1/robots/" + link::PercentEncoded(bad_ruri_)));
  }
}

std::string Watch::Get(const std::string& target) {
  const SteadyTime began = clock_.Steady();
  auto body = client_.Get(target);
  const double took = std::chrono::duration<double, std::milli>(clock_.Steady() - began).count();
  const std::lock_guard lock(mutex_);
  WatchFigures& figures = Present();
  figures.slowest_ms = std::max(figures.slowest_ms, took);
  if (body.ok()) return *std::move(body);
  ++figures.failed;
  figures.last_failure = body.status().ToString();
  return "";
}

void Watch::Scrape() {
  const std::string page = Get("/metrics");
  if (page.empty()) return;
  const auto samples = SamplesOf(page);
  const std::string broken = BrokenLaw(samples);
  const std::lock_guard lock(mutex_);
  WatchFigures& figures = Present();
  ++figures.scrapes;
  if (!broken.empty() && figures.law_broken++ == 0) figures.law_example = broken;
  figures.held_back = std::max(figures.held_back, SumOf(samples, "uplinkd_streams_held_back{"));
  figures.journal_bytes =
      std::max(figures.journal_bytes, FigureOf(samples, "uplinkd_journal_bytes"));
}

void Watch::LookForPresence(const char* presence, std::set<std::string> WatchFigures::*seen) {
  const std::string page =
      Get(fmt::format("/api/v1/robots?presence={}&parts=usage&pageSize=1000", presence));
  std::set<std::string> ruris = RurisOf(page);
  std::erase_if(ruris, [this](const std::string& ruri) { return ruri.starts_with(bad_ruri_); });
  const std::lock_guard lock(mutex_);
  (Present().*seen).merge(ruris);
}

}  // namespace uplink::bench
