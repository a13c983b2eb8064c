#include "tests/bench/fair/scrape.h"

#include <cstdlib>

#include <boost/json.hpp>
#include <fmt/core.h>

namespace uplink::bench {

std::map<std::string, double> SamplesOf(std::string_view page) {
  std::map<std::string, double> samples;
  while (!page.empty()) {
    const std::size_t end = page.find('\n');
    const std::string_view line = page.substr(0, end);
    page.remove_prefix(end == std::string_view::npos ? page.size() : end + 1);
    const std::size_t space = line.rfind(' ');
    if (line.starts_with('#') || space == std::string_view::npos || space == 0) continue;
    const std::string value(line.substr(space + 1));
    char* stopped = nullptr;
    const double number = std::strtod(value.c_str(), &stopped);
    if (stopped != value.c_str() && *stopped == '\0') {
      samples.emplace(line.substr(0, space), number);
    }
  }
  return samples;
}

std::string BrokenLaw(const std::map<std::string, double>& samples) {
  double received = 0;
  double settled = 0;
  double in_flight = 0;
  for (const auto& [name, value] : samples) {
    if (name == "uplinkd_uplinks_received_total") received = value;
    if (name == "uplinkd_uplinks_in_flight") in_flight = value;
    if (name.starts_with("uplinkd_uplinks_settled_total{")) settled += value;
  }
  // Counts are whole, and exact as doubles far beyond what a run sends.
  if (received == settled + in_flight) return "";
  return fmt::format("received {:.0f}, settled {:.0f}, in flight {:.0f}", received, settled,
                     in_flight);
}

std::set<std::string> RurisOf(const std::string& page) {
  std::set<std::string> ruris;
  boost::system::error_code error;
  const boost::json::value parsed = boost::json::parse(page, error);
  const auto* object = error ? nullptr : parsed.if_object();
  const auto* robots = object == nullptr ? nullptr : object->if_contains("robots");
  const auto* list = robots == nullptr ? nullptr : robots->if_array();
  if (list == nullptr) return ruris;
  for (const boost::json::value& each : *list) {
    const auto* robot = each.if_object();
    const auto* ruri = robot == nullptr ? nullptr : robot->if_contains("ruri");
    if (ruri != nullptr && ruri->is_string()) ruris.emplace(ruri->as_string());
  }
  return ruris;
}

}  // namespace uplink::bench
