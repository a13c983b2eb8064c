#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "metrics/rcan/page.h"
#include "schema/base/clock.h"
#include "server/rcan/name_hash.h"
#include "server/rcan/series_names.h"

namespace uplink::rcan {

/// The bounds of the series of each robot. Immutable.
struct NameRules {
  NameHash hash;
  SeriesNames::Limits limits;
};

/// Series of one robot that a scrape left out, by reason. A value.
struct SeriesLeftOut {
  /// The robot has rcan.robot_series_max other series.
  std::size_t over_max = 0;
  /// They are new, and rcan.robot_new_names_max others were new lately.
  std::size_t new_names = 0;

  [[nodiscard]] std::size_t all() const { return over_max + new_names; }
};

/// Writes the series of one robot that carry a name of the robot's own into the page of a scrape. A
/// robot has at most rcan.robot_series_max series; those that are added first are admitted first.
/// Confined to one thread; for one robot of one scrape.
class NamedSeries final {
 public:
  struct Scrape {
    SteadyTime now;
    /// Series of the robot that the page has already, without names.
    std::size_t basic = 0;
  };
  /// `names`: those of the robot up to the last scrape. All outlive this.
  NamedSeries(metrics::rcan::SeriesPage& page, SeriesNames& names, const NameRules& rules,
              const Scrape& scrape)
      : page_(page), names_(names), rules_(rules), scrape_(scrape) {}

  /// Adds the values of `first` and of the series after it, at most SeriesNames::kOfLabelMax; an
  /// empty value gets no sample.
  void Add(metrics::rcan::SeriesId first, std::string_view label,
           std::span<const std::optional<double>> values);

  [[nodiscard]] const SeriesLeftOut& left_out() const { return left_out_; }

 private:
  [[nodiscard]] SeriesNames::Answer Admit(metrics::rcan::SeriesId first, std::string_view label,
                                          SeriesNames::Set wanted);

  metrics::rcan::SeriesPage& page_;
  SeriesNames& names_;
  const NameRules& rules_;
  const Scrape scrape_;
  bool begun_ = false;
  SeriesLeftOut left_out_;
};

}  // namespace uplink::rcan
