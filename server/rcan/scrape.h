#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <unordered_set>
#include <vector>

#include "metrics/format.h"
#include "metrics/rcan/page.h"
#include "schema/base/clock.h"
#include "server/config/config.h"
#include "server/cyberwave/twins.h"
#include "server/fleet/fleet.h"
#include "server/limits/recent_times.h"
#include "server/log/rate_limited.h"
#include "server/rcan/fault_counts.h"
#include "server/rcan/named_series.h"
#include "server/rcan/probe.h"
#include "server/rcan/robot_series.h"
#include "server/rcan/text_pool.h"
#include "server/rcan/turns.h"
#include "server/uncrew/drones.h"
#include "storage/reader.h"

namespace uplink::rcan {

/// Texts that scrapers are reading at a time; the memory of scrapes is at most so many texts and
/// the page that they are made of.
inline constexpr std::size_t kTextsMax = 4;
/// A text that is being read is given to others who ask for the same for so long.
inline constexpr std::chrono::seconds kTextShared{1};
/// A robot of which series are left out is named in the log once in so long, and at most so many
/// robots per minute.
inline constexpr std::chrono::hours kRobotNamedEvery{1};
inline constexpr std::uint32_t kRobotsNamedMax = 10;
/// A fleet that was not scraped for so long is not asked for its faults any more.
inline constexpr std::chrono::minutes kScrapedWithin{5};

/// What /metrics/robots answers. It never waits for the store, and holds a robot's lock only while
/// that robot is written.
///
/// The basic series of all robots come first. The room that is left of rcan.series_max goes to
/// series with a word of the robots' own, of a robot all or none; both in turns (ScrapeTurns).
///
/// Thread: Text on one thread at a time; the texts go to any.
class RobotScrape final {
 public:
  /// The references outlive it.
  struct Sources {
    const Clock& clock;
    const fleet::Fleet& fleet;
    const config::RcanConfig& config;
    FaultCounts& faults;
    RcanProbe& probe;
    log::Logger& logger;
    /// Secret (NameHash::Draw); tests may leave it at zero.
    NameHash::Key name_key{};
    /// What is heard from a broker; null: nothing is.
    const cyberwave::Twins* twins = nullptr;
    /// What drones say by calls, and uncrew.stale_after; null: none call.
    const uncrew::Drones* drones = nullptr;
    milliseconds drones_stale_after{0};
  };
  explicit RobotScrape(const Sources& sources);

  /// The text; the scraper's for as long as it holds it. Null if too many are being read.
  [[nodiscard]] std::shared_ptr<const std::string> Text(metrics::Format format,
                                                        metrics::Coding coding);
  /// Whether anybody scraped lately.
  [[nodiscard]] bool wanted() const;
  /// Whether the last scrape left out series for want of room, and was so lately.
  ///
  /// Thread: any.
  [[nodiscard]] bool full() const { return full_.load() && wanted(); }
  /// Has the active faults counted anew, if wanted: FaultCounts::RefreshOn.
  ///
  /// Thread: any.
  void CountFaultsOn(const loop::Post& post, storage::Reader& reader);

 private:
  /// A robot of the fleet, and what is kept of it from scrape to scrape.
  struct Known {
    std::weak_ptr<robot::Robot> robot;
    /// The most samples that it ever had while its values are shown, so that who is left out does
    /// not change from scrape to scrape.
    std::size_t basic_room = 0;
    std::size_t named_room = 0;
    /// At this scrape; kPresence too if it is left out whole.
    Shown shown = Shown::kPresence;
    SeriesNames names;
    /// In the log.
    limits::RecentTimes<1> named;
  };
  /// What a scrape left out.
  struct LeftOut {
    /// Whole.
    std::size_t robots = 0;
    /// All but the basic series.
    std::size_t robots_named = 0;
    std::size_t robots_incomplete = 0;
    SeriesLeftOut series;
    /// The basic ones of whole robots not counted.
    std::size_t series_no_room = 0;
  };

  void Fill();
  /// All that are shown have a turn each.
  void ListTurns(std::vector<Known>& robots);
  ScrapeTurns::Turn AddBasicOf(Known& known, SeriesSources& sources, LeftOut& left_out);
  ScrapeTurns::Turn AddNamedOf(Known& known, const SeriesSources& sources, LeftOut& left_out);
  /// The robot's twin, if it is one that was heard; or null.
  [[nodiscard]] cyberwave::TwinPtr TwinOf(const std::string& ruri) const;
  /// Calls `look` under the drone's lock, if the robot is one that called.
  void LookAtDrone(const std::string& ruri,
                   const std::function<void(const uncrew::LiveSamples&)>& look) const;
  void Count(const LeftOut& left_out);
  void TellRoom(const LeftOut& left_out);
  void Name(Known& known, const std::string& ruri, const SeriesLeftOut& series, SteadyTime now);
  [[nodiscard]] std::vector<Known>& Robots();

  const Sources sources_;
  const std::unordered_set<std::string> fleets_;
  metrics::rcan::SeriesPage page_;
  const std::shared_ptr<TextPool> texts_ = std::make_shared<TextPool>();
  std::string plain_;
  /// The last text, while somebody reads it.
  struct Shared {
    std::weak_ptr<const std::string> text;
    metrics::Format format = metrics::Format::kText;
    metrics::Coding coding = metrics::Coding::kPlain;
    SteadyTime at;
  };
  Shared last_;
  const NameRules names_;
  /// By RURI; read again when robots came or went.
  std::vector<Known> robots_;
  ScrapeTurns turns_;
  std::uint64_t fleet_changes_ = 0;
  log::RateLimited left_out_;
  log::RateLimited series_left_out_;
  std::atomic<SteadyTime> scraped_at_{SteadyTime()};
  std::atomic<bool> full_{false};
};

}  // namespace uplink::rcan
