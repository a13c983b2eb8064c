#include "tools/uplink-fleet/twin/script.h"

#include <array>
#include <cstddef>
#include <iterator>
#include <utility>

namespace uplink::synthetic {
namespace {

/// Of all messages, those that are stored, those that are wrong, and metrics that clear errors.
constexpr double kStoredShare = 0.25;
constexpr double kWrongShare = 0.02;
constexpr double kMetricsShare = 0.03;

/// What is stored comes from here.
enum class From : std::uint8_t { kHappenings, kNavigation, kMission, kErrors, kViewer };
struct Source {
  From from;
  std::size_t weight;
};
constexpr std::array<Source, 5> kSources = {{{From::kHappenings, 20},
                                             {From::kNavigation, 4},
                                             {From::kMission, 3},
                                             {From::kErrors, 2},
                                             {From::kViewer, 2}}};

}  // namespace

TwinScript::TwinScript(const TwinOptions& options)
    : voice_(options),
      live_({voice_, account_}),
      metrics_({voice_, account_}),
      happenings_({voice_, account_}),
      runs_({voice_, account_}),
      wrongs_({voice_, account_}) {}

std::vector<Publication> TwinScript::First(std::int64_t now_us) {
  voice_.SetNow(now_us);
  std::vector<Publication> first;
  for (const Speaker speaker : {Speaker::kDriver, Speaker::kSimulation}) {
    first.push_back(happenings_.Mark(speaker, "connected"));
    first.push_back(happenings_.Mark(speaker, "telemetry_start"));
  }
  // Who subscribes later gets it, and must not take it for news.
  first.push_back(live_.Of(Side::kReal, "scale"));
  first.back().retain = true;
  first.push_back(live_.Of(Side::kSim, "position"));
  return first;
}

Publication TwinScript::Next(std::int64_t now_us) {
  voice_.SetNow(now_us);
  double what = voice_.chance().Unit();
  // Where no more may be remembered nothing may raise or clear a fault either.
  if (account_.Full()) return live_.Next();
  if (what < kStoredShare) return Stored();
  what -= kStoredShare;
  if (what < kWrongShare) return wrongs_.Next();
  return what < kWrongShare + kMetricsShare ? metrics_.Good() : live_.Next();
}

Publication TwinScript::Stored() {
  switch (Choose(voice_.chance(), kSources).from) {
    case From::kHappenings:
      return happenings_.Next();
    case From::kNavigation:
      return runs_.Navigate();
    case From::kMission:
      return runs_.Mission();
    case From::kErrors:
      return metrics_.WithErrors();
    case From::kViewer:
      break;
  }
  return ViewerMark();
}

Publication TwinScript::ViewerMark() {
  viewer_there_ = !viewer_there_;
  if (viewer_there_) return happenings_.Mark(Speaker::kViewer, "connected");
  return happenings_.Mark(Speaker::kViewer,
                          voice_.chance().Chance(0.5) ? "disconnected" : "telemetry_end");
}

std::vector<Publication> TwinScript::Last(std::int64_t now_us) {
  voice_.SetNow(now_us);
  std::vector<Publication> last;
  // The retained one first: the empty message is one that the server may reject.
  Publication none;
  none.number = voice_.BeginBare().number;
  none.topic = voice_.Topic("twin/{twin}/scale");
  none.retain = true;
  account_.Wrong(none.number, {.reason = model::RejectReason::kMalformed,
                               .topic = none.topic,
                               .bytes = 0,
                               .of_no_robot = false,
                               .sure = false});
  last.push_back(std::move(none));
  last.push_back(metrics_.WithErrors());
  for (Publication& each : live_.All()) last.push_back(std::move(each));
  return last;
}

}  // namespace uplink::synthetic
