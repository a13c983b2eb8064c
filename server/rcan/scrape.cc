#include "server/rcan/scrape.h"

#include <algorithm>
#include <utility>

#include "metrics/gzip.h"
#include "server/rcan/robot_series.h"

namespace uplink::rcan {
RobotScrape::RobotScrape(const Sources& sources)
    : sources_(sources),
      fleets_(sources.config.fleets.begin(), sources.config.fleets.end()),
      page_({.subsystem = sources.config.subsystem,
             .fields = sources.config.fields,
             .series_max = sources.config.series_max}),
      left_out_(sources.logger, 1, std::chrono::minutes(1)) {}

bool RobotScrape::wanted() const {
  const SteadyTime at = scraped_at_.load();
  return at != SteadyTime() && sources_.clock.Steady() - at < kScrapedWithin;
}

const std::vector<std::weak_ptr<robot::Robot>>& RobotScrape::Robots() {
  // First: a robot that comes meanwhile is a change that the next scrape sees.
  const std::uint64_t changes = sources_.fleet.changes();
  if (changes == fleet_changes_) return robots_;
  fleet_changes_ = changes;
  const std::vector<fleet::RobotPtr> robots = sources_.fleet.Sorted();
  robots_.assign(robots.begin(), robots.end());
  std::unordered_map<const robot::Robot*, std::size_t> room;
  for (const fleet::RobotPtr& robot : robots) {
    const auto known = room_.find(robot.get());
    if (known != room_.end()) room.insert(*known);
  }
  room_ = std::move(room);
  return robots_;
}

void RobotScrape::Fill() {
  const std::shared_ptr<const FaultCounts::Map> faults = sources_.faults.counts();
  const SeriesSources series{.now = sources_.clock.System(),
                             .steady_now = sources_.clock.Steady(),
                             .series_ttl = sources_.config.series_ttl,
                             .presence_timeout = sources_.fleet.presence_limits().timeout,
                             .extras = sources_.config.extras,
                             .faults = faults.get()};
  page_.Clear();
  std::size_t left_out = 0;
  for (const std::weak_ptr<robot::Robot>& known : Robots()) {
    const fleet::RobotPtr robot = known.lock();
    if (robot == nullptr) continue;
    if (!fleets_.empty() && !fleets_.contains(robot->id()->fleet)) continue;
    page_.BeginRobot(robot->ruri());
    bool shown = false;
    robot->state.LookAt([&](const robot::StateView& view) {
      shown = AddRobot(robot->ruri(), view, series, page_);
    });
    std::size_t& room = room_[robot.get()];
    room = shown ? std::max(room, page_.robot_samples()) : page_.robot_samples();
    if (!page_.EndRobot(room)) ++left_out;
  }
  sources_.probe.series.Set(static_cast<std::int64_t>(page_.samples()));
  sources_.probe.robots_left_out.Set(static_cast<std::int64_t>(left_out));
  LogLeftOut(left_out);
}

void RobotScrape::LogLeftOut(std::size_t robots) {
  if (robots == 0) return;
  left_out_.Write(log::Level::kWarn, "rcan_robots_left_out",
                  {{"robots", robots}, {"series_max", sources_.config.series_max}});
}

std::shared_ptr<const std::string> RobotScrape::Text(metrics::Format format,
                                                     metrics::Coding coding) {
  const SteadyTime began = sources_.clock.Steady();
  scraped_at_.store(began);
  if (last_.format == format && last_.coding == coding && began - last_.at < kTextShared) {
    if (auto read = last_.text.lock()) return read;
  }
  std::shared_ptr<std::string> text = texts_->Take(kTextsMax);
  if (text == nullptr) {
    sources_.probe.refused_total.Add();
    return nullptr;
  }
  Fill();
  const bool compressed = coding == metrics::Coding::kGzip;
  page_.Write(format, compressed ? plain_ : *text);
  sources_.probe.bytes.Set(static_cast<std::int64_t>((compressed ? plain_ : *text).size()));
  if (compressed) metrics::Gzip(plain_, *text);
  sources_.probe.scrape_seconds.ObserveSince(began, sources_.clock.Steady());
  last_ = {.text = text, .format = format, .coding = coding, .at = began};
  return text;
}

}  // namespace uplink::rcan
