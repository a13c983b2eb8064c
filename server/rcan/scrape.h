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
#include "server/fleet/top_senders.h"
#include "server/limits/recent_times.h"
#include "server/log/rate_limited.h"
#include "server/rcan/named_series.h"
#include "server/rcan/probe.h"
#include "server/rcan/robot_info.h"
#include "server/rcan/robot_series.h"
#include "server/rcan/scope_counts.h"
#include "server/rcan/text_pool.h"
#include "server/rcan/turns.h"
#include "server/uncrew/drones.h"
#include "server/view/fault_counts.h"
#include "storage/reader.h"

namespace uplink::rcan {

/// Texts that scrapers may read at a time. The memory of scrapes is at most so many texts, and the
/// page from which they are made.
inline constexpr std::size_t kTextsMax = 4;
/// Of those, texts that neither scrapers of listen.metrics nor those of some fleets can take.
inline constexpr std::size_t kTextsReserved = 1;
/// Texts of the same fleets that may be read at a time: two servers of Prometheus.
inline constexpr std::size_t kTextsOfFleets = 2;
/// For so long, a text that a scraper reads also goes to others that ask for the same.
inline constexpr std::chrono::seconds kTextShared{1};
/// Robots that are shown as those that send most, by messages and by bytes.
inline constexpr std::size_t kTopShown = 10;
/// How often the log names a robot whose series are left out, and how many robots per minute at
/// most.
inline constexpr std::chrono::hours kRobotNamedEvery{1};
inline constexpr std::uint32_t kRobotsNamedMax = 10;
/// After so long without a scrape, the store is not asked for faults any more.
inline constexpr std::chrono::minutes kScrapedWithin{5};

/// The answer of /metrics/robots. It never waits for the store, and holds a robot's lock only while
/// it writes that robot.
///
/// The basic series of all robots come first. The rest of rcan.series_max goes to series with names
/// of the robots' own, for each robot all or none. Robots take turns for both (ScrapeTurns).
///
/// Thread: Text on one thread at a time; the texts go to any.
class RobotScrape final {
 public:
  /// The references outlive it.
  struct Sources {
    const Clock& clock;
    const fleet::Fleet& fleet;
    const config::RcanConfig& config;
    view::FaultCounts& faults;
    RcanProbe& probe;
    log::Logger& logger;
    /// Secret (NameHash::Draw); tests may leave it at zero.
    NameHash::Key name_key{};
    /// The twins of a broker; null: no broker is read.
    const cyberwave::Twins* twins = nullptr;
    /// The drones that call, and uncrew.stale_after; null: none can.
    const uncrew::Drones* drones = nullptr;
    milliseconds drones_stale_after{0};
    /// Who sends most; null: that is not shown.
    fleet::TopSenders* top = nullptr;
  };
  explicit RobotScrape(const Sources& sources);

  /// The text of the robots of `fleets`, as if there were no others; none: of all. It stays as it
  /// is while the scraper holds it. Null if `texts_max` or more are being read, or kTextsOfFleets
  /// of these fleets.
  [[nodiscard]] std::shared_ptr<const std::string> Text(
      metrics::Format format, metrics::Coding coding, std::size_t texts_max = kTextsMax,
      const std::vector<std::string>& fleets = {});
  /// Whether there was a scrape lately.
  [[nodiscard]] bool wanted() const;
  /// Whether the last scrape of some fleets was lately, and left out series for lack of room.
  ///
  /// Thread: any.
  [[nodiscard]] bool full() const { return IsLately(full_at_.load()); }
  /// Counts the active faults anew, if wanted (FaultCounts::RefreshOn).
  ///
  /// Thread: any.
  void CountFaultsOn(const loop::Post& post, storage::Reader& reader);

 private:
  /// A robot of the fleet, with what scrapes remember about it.
  struct Known {
    std::weak_ptr<robot::Robot> robot;
    /// The most samples that it had so far while its values are shown: so the robots that are left
    /// out do not change from scrape to scrape.
    std::size_t basic_room = 0;
    std::size_t named_room = 0;
    /// At this scrape; also kPresence if the whole robot is left out.
    Shown shown = Shown::kPresence;
    SeriesNames names;
    /// Its versions.
    SeriesNames infos;
    /// When the log named it.
    limits::RecentTimes<1> named;
  };
  /// What a scrape left out.
  struct LeftOut {
    /// Whole robots.
    std::size_t robots = 0;
    /// Robots without all series but the basic ones.
    std::size_t robots_named = 0;
    std::size_t robots_incomplete = 0;
    SeriesLeftOut series;
    /// Without the basic series of whole robots.
    std::size_t series_no_room = 0;
  };

  [[nodiscard]] bool IsLately(SteadyTime scraped_at) const;
  [[nodiscard]] bool Shows(const std::vector<std::string>& fleets, const std::string& fleet) const;
  LeftOut Fill(const std::vector<std::string>& fleets);
  /// Adds the robots that send most.
  void AddTop(const std::vector<std::string>& fleets);
  /// Adds what the robot is. `agent_version` as its last connection
  /// said; empty: its AgentInfo's counts.
  void AddInfoOf(const model::RobotId& id, std::string_view agent_version,
                 const robot::StateView& view, Known& known, SteadyTime now);
  /// Adds a turn for each robot that is shown.
  void ListTurns(std::vector<Known>& robots, const std::vector<std::string>& fleets);
  ScrapeTurns::Turn AddBasicOf(Known& known, SeriesSources& sources, LeftOut& left_out);
  ScrapeTurns::Turn AddNamedOf(Known& known, const SeriesSources& sources, LeftOut& left_out);
  /// The robot's twin, if it was heard; otherwise null.
  [[nodiscard]] cyberwave::TwinPtr TwinOf(const std::string& ruri) const;
  /// Calls `look` under the drone's lock, if the robot is a drone that called.
  void LookAtDrone(const std::string& ruri,
                   const std::function<void(const uncrew::LiveSamples&)>& look) const;
  void Count(const LeftOut& left_out, const std::vector<std::string>& fleets, std::size_t bytes);
  void TellRoom(const LeftOut& left_out);
  void Name(Known& known, const std::string& ruri, const SeriesLeftOut& series, SteadyTime now);
  [[nodiscard]] std::vector<Known>& Robots();

  const Sources sources_;
  const std::unordered_set<std::string> fleets_;
  metrics::rcan::SeriesPage page_;
  const std::shared_ptr<TextPool> texts_ = std::make_shared<TextPool>();
  std::string plain_;
  /// The last text, while a scraper reads it.
  struct Shared {
    std::weak_ptr<const std::string> text;
    metrics::Format format = metrics::Format::kText;
    metrics::Coding coding = metrics::Coding::kPlain;
    std::vector<std::string> fleets;
    SteadyTime at;
  };
  Shared last_;
  const NameRules names_;
  /// By RURI; read again after robots entered or left memory.
  std::vector<Known> robots_;
  ScrapeTurns turns_;
  std::uint64_t fleet_changes_ = 0;
  log::RateLimited left_out_;
  log::RateLimited series_left_out_;
  std::atomic<SteadyTime> scraped_at_{SteadyTime()};
  ScopeCounts counts_{kScrapedWithin};
  std::atomic<SteadyTime> full_at_{SteadyTime()};
};

}  // namespace uplink::rcan
