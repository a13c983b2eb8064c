#include "server/rcan/scrape.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include <absl/strings/str_join.h>

#include "metrics/gzip.h"
#include "schema/cyberwave/ruri.h"
#include "schema/model/message_source.h"
#include "server/rcan/drone_series.h"
#include "server/rcan/twin_series.h"
#include "server/robot/session_view.h"
#include "storage/fleets.h"
#include "storage/origin.h"

namespace uplink::rcan {
namespace {

Way WayOf(const robot::Robot& robot, const robot::SessionView& session) {
  if (robot.source() == model::MessageSource::kCyberwave) return Way::kBroker;
  if (session.connected_since == SystemTime()) return Way::kNotHeard;
  return session.gateway.empty() ? Way::kOwnStream : Way::kGateway;
}

Sharer SharerOf(const robot::Robot& robot) {
  robot::SessionView session = robot.sessions.View();
  const Way way = WayOf(robot, session);
  return {.fleet = robot.id()->fleet, .way = way, .gateway = std::move(session.gateway)};
}

}  // namespace

RobotScrape::RobotScrape(const Sources& sources)
    : sources_(sources),
      fleets_(sources.config.fleets.begin(), sources.config.fleets.end()),
      page_({.subsystem = sources.config.subsystem,
             .fields = sources.config.fields,
             .series_max = sources.config.series_max}),
      names_({.hash = NameHash(sources.name_key),
              .limits = {.names_max = sources.config.robot_series_max,
                         .new_per_hour = sources.config.robot_new_names_max,
                         .forget_after = sources.config.series_ttl}}),
      left_out_(sources.logger, 1, std::chrono::minutes(1)),
      series_left_out_(sources.logger, kRobotsNamedMax, std::chrono::minutes(1)) {}

bool RobotScrape::IsLately(SteadyTime scraped_at) const {
  return scraped_at != SteadyTime() && sources_.clock.Steady() - scraped_at < kScrapedWithin;
}

bool RobotScrape::wanted() const { return IsLately(scraped_at_.load()); }

bool RobotScrape::Shows(const std::vector<std::string>& fleets, const std::string& fleet) const {
  return storage::LooksAt(fleets, fleet) && (fleets_.empty() || fleets_.contains(fleet));
}

void RobotScrape::CountFaultsOn(const loop::Post& post, storage::Reader& reader) {
  if (wanted()) sources_.faults.RefreshOn(post, sources_.fleet, reader);
}

std::vector<RobotScrape::Known>& RobotScrape::Robots() {
  // Read first: a robot that comes meanwhile is a change that the next scrape sees.
  const std::uint64_t changes = sources_.fleet.changes();
  if (changes == fleet_changes_) return robots_;
  fleet_changes_ = changes;
  // A weak pointer keeps the address of a robot that is gone from being used again.
  std::unordered_map<const robot::Robot*, Known*> before;
  for (Known& known : robots_) {
    if (const fleet::RobotPtr robot = known.robot.lock()) before.emplace(robot.get(), &known);
  }
  std::vector<Known> robots;
  for (const fleet::RobotPtr& robot : sources_.fleet.Sorted()) {
    if (storage::IsNoRobot(robot->ruri())) continue;
    const auto known = before.find(robot.get());
    robots.push_back(known != before.end() ? std::move(*known->second)
                                           : Known{.robot = robot, .names = {}});
  }
  robots_ = std::move(robots);
  return robots_;
}

RobotScrape::LeftOut RobotScrape::Fill(const std::vector<std::string>& fleets) {
  const std::shared_ptr<const view::FaultCounts::Map> faults = sources_.faults.counts();
  SeriesSources series{.now = sources_.clock.System(),
                       .steady_now = sources_.clock.Steady(),
                       .series_ttl = sources_.config.series_ttl,
                       .extras = sources_.config.extras,
                       .faults = faults.get()};
  page_.Clear();
  std::vector<Known>& robots = Robots();
  ListTurns(robots, fleets);
  LeftOut left_out;
  AddTop(fleets);
  turns_.Give([&](std::size_t i) { return AddBasicOf(robots[i], series, left_out); });
  turns_.Give([&](std::size_t i) { return AddNamedOf(robots[i], series, left_out); });
  return left_out;
}

void RobotScrape::AddTop(const std::vector<std::string>& fleets) {
  if (sources_.top == nullptr || !page_.Writes(metrics::rcan::SeriesId::kTop)) return;
  for (const fleet::TopBy by : {fleet::TopBy::kMessages, fleet::TopBy::kBytes}) {
    for (const auto& sender : sources_.top->Most(by, kTopShown, fleets)) {
      if (!Shows(fleets, sender.fleet)) continue;
      page_.BeginRobot(sender.ruri);
      page_.Add(metrics::rcan::SeriesId::kTop, fleet::kTopByNames[static_cast<std::size_t>(by)],
                sender.per_second);
      page_.EndRobot();
    }
  }
}

void RobotScrape::AddInfoOf(const model::RobotId& id, std::string_view agent_version,
                            const robot::StateView& view, Known& known, SteadyTime now) {
  if (agent_version.empty()) agent_version = view.reported.agent_version;
  AddInfo({.ruri = id.ruri,
           .fleet = id.fleet,
           .software_version = view.reported.software_version,
           .agent_version = agent_version},
          known.infos, names_, now, page_);
}

void RobotScrape::ListTurns(std::vector<Known>& robots, const std::vector<std::string>& fleets) {
  turns_.Clear();
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const fleet::RobotPtr robot = robots[i].robot.lock();
    if (robot == nullptr) continue;
    Sharer sharer = SharerOf(*robot);
    if (!Shows(fleets, sharer.fleet)) continue;
    turns_.Add(std::move(sharer), i);
  }
}

ScrapeTurns::Turn RobotScrape::AddBasicOf(Known& known, SeriesSources& sources, LeftOut& left_out) {
  known.shown = Shown::kPresence;
  const fleet::RobotPtr robot = known.robot.lock();
  if (robot == nullptr) return {};
  sources.presence_timeout = sources_.fleet.presence_limits_of(*robot).timeout;
  const storage::RobotRef id = robot->id();
  const std::string agent_version = robot->agent.Get().version;
  page_.BeginRobot(robot->ruri());
  robot->state.LookAt([&](const robot::StateView& view) {
    known.shown = AddBasic(robot->ruri(), view, sources, page_);
    // A robot that is unknown, or that another process holds, has no sample.
    if (page_.robot_samples() > 0) {
      AddInfoOf(*id, agent_version, view, known, sources.steady_now);
    }
  });
  if (known.shown == Shown::kPresence) {
    known.basic_room = 0;
    known.named_room = 0;
  } else if (const cyberwave::TwinPtr twin = TwinOf(robot->ruri())) {
    twin->LookAt([this](const cyberwave::TwinParts& parts) { AddTwinBasic(parts, page_); });
  }
  if (known.shown != Shown::kPresence) {
    LookAtDrone(robot->ruri(), [&](const uncrew::LiveSamples& live) {
      AddDroneBasic(live, sources.steady_now, sources_.drones_stale_after, page_);
    });
  }
  known.basic_room = std::max(known.basic_room, page_.robot_samples());
  if (page_.EndRobot(known.basic_room)) return {.taken = known.basic_room};
  known.shown = Shown::kPresence;
  ++left_out.robots;
  return {.left_out = known.basic_room};
}

ScrapeTurns::Turn RobotScrape::AddNamedOf(Known& known, const SeriesSources& sources,
                                          LeftOut& left_out) {
  if (known.shown == Shown::kPresence) return {};
  const fleet::RobotPtr robot = known.robot.lock();
  if (robot == nullptr) return {};
  page_.BeginRobot(robot->ruri());
  NamedSeries series(page_, known.names, names_,
                     {.now = sources.steady_now, .basic = known.basic_room});
  robot->state.LookAt(
      [&](const robot::StateView& view) { AddNamed(view, known.shown, sources.extras, series); });
  if (const cyberwave::TwinPtr twin = TwinOf(robot->ruri())) {
    twin->LookAt([&series](const cyberwave::TwinParts& parts) { AddTwinNamed(parts, series); });
  }
  LookAtDrone(robot->ruri(), [&](const uncrew::LiveSamples& live) {
    AddDroneNamed(live, sources.steady_now, sources_.drones_stale_after, series);
  });
  const std::size_t samples = page_.robot_samples();
  known.named_room = std::max(known.named_room, samples);
  const bool fits = page_.EndRobot(known.named_room);
  if (!fits && samples > 0) {
    ++left_out.robots_named;
    ++left_out.robots_incomplete;
    left_out.series_no_room += samples;
    return {.left_out = known.named_room};
  }
  if (const SeriesLeftOut& missing = series.left_out(); missing.all() > 0) {
    ++left_out.robots_incomplete;
    left_out.series.over_max += missing.over_max;
    left_out.series.new_names += missing.new_names;
    Name(known, robot->ruri(), missing, sources.steady_now);
  }
  return {.taken = fits ? known.named_room : 0};
}

cyberwave::TwinPtr RobotScrape::TwinOf(const std::string& ruri) const {
  if (sources_.twins == nullptr || !cyberwave::IsTwinRuri(ruri)) return nullptr;
  return sources_.twins->Find(ruri);
}

void RobotScrape::LookAtDrone(const std::string& ruri,
                              const std::function<void(const uncrew::LiveSamples&)>& look) const {
  if (sources_.drones == nullptr) return;
  if (const auto drone = sources_.drones->Find(ruri)) drone->LookAt(look);
}

void RobotScrape::Count(const LeftOut& left_out, const std::vector<std::string>& fleets,
                        std::size_t bytes) {
  const bool full = left_out.robots > 0 || left_out.robots_named > 0;
  counts_.Note(fleets,
               {.series = static_cast<std::int64_t>(page_.samples()),
                .robots_left_out = static_cast<std::int64_t>(left_out.robots),
                .robots_incomplete = static_cast<std::int64_t>(left_out.robots_incomplete),
                .bytes = static_cast<std::int64_t>(bytes)},
               full, scraped_at_.load());
  full_at_.store(counts_.full_at());
  const ScopeCounts::Counts largest = counts_.Largest();
  RcanProbe& probe = sources_.probe;
  probe.series.Set(largest.series);
  probe.robots_left_out.Set(largest.robots_left_out);
  probe.robots_incomplete.Set(largest.robots_incomplete);
  probe.bytes.Set(largest.bytes);
  probe.series_over_max_total.Add(static_cast<std::int64_t>(left_out.series.over_max));
  probe.series_new_names_total.Add(static_cast<std::int64_t>(left_out.series.new_names));
  probe.series_no_room_total.Add(static_cast<std::int64_t>(left_out.series_no_room));
  if (full) TellRoom(left_out);
}

void RobotScrape::TellRoom(const LeftOut& left_out) {
  const auto most = turns_.Greediest().value_or(ScrapeTurns::Share());
  left_out_.Write(log::Level::kWarn, "rcan_robots_left_out",
                  {{"robots", left_out.robots},
                   {"series_max", sources_.config.series_max},
                   {"robots_basic_alone", left_out.robots_named},
                   {"most_fleet", most.sharer.fleet},
                   {"most_way", ToText(most.sharer.way)},
                   {"most_gateway", most.sharer.gateway},
                   {"most_series", most.series.taken},
                   {"most_left_out", most.series.left_out}});
}

void RobotScrape::Name(Known& known, const std::string& ruri, const SeriesLeftOut& series,
                       SteadyTime now) {
  if (known.named.IsFull(now, kRobotNamedEvery)) return;
  const bool named = series_left_out_.Write(log::Level::kWarn, "rcan_series_left_out",
                                            {{"robot", ruri},
                                             {"over_robot_series_max", series.over_max},
                                             {"over_robot_new_names_max", series.new_names}});
  // A robot that was not named now is named at a later scrape.
  if (named) known.named.Note(now);
}

std::shared_ptr<const std::string> RobotScrape::Text(metrics::Format format, metrics::Coding coding,
                                                     std::size_t texts_max,
                                                     const std::vector<std::string>& fleets) {
  const SteadyTime began = sources_.clock.Steady();
  scraped_at_.store(began);
  const bool is_same = last_.format == format && last_.coding == coding && last_.fleets == fleets;
  if (is_same && began - last_.at < kTextShared) {
    if (auto read = last_.text.lock()) return read;
  }
  TextPool::Reader reader{.out_max = kTextsMax};
  if (!fleets.empty()) {
    // Who does not read keeps out neither other fleets nor who scrapes all.
    reader = {.name = absl::StrJoin(fleets, ","), .out_max = kTextsOfFleets};
    texts_max = std::min(texts_max, kTextsMax - kTextsReserved);
  }
  std::shared_ptr<std::string> text = texts_->Take(texts_max, reader);
  if (text == nullptr) {
    sources_.probe.refused_total.Add();
    return nullptr;
  }
  const LeftOut left_out = Fill(fleets);
  const bool compressed = coding == metrics::Coding::kGzip;
  page_.Write(format, compressed ? plain_ : *text);
  Count(left_out, fleets, (compressed ? plain_ : *text).size());
  if (compressed) metrics::Gzip(plain_, *text);
  sources_.probe.scrape_seconds.ObserveSince(began, sources_.clock.Steady());
  last_ = {.text = text, .format = format, .coding = coding, .fleets = fleets, .at = began};
  return text;
}

}  // namespace uplink::rcan
