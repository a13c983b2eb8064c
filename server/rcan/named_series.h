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

/// What bounds the series of each robot. Immutable.
struct NameRules {
  NameHash hash;
  SeriesNames::Limits limits;
};

/// Series of one robot that a scrape left out, by why. A value.
struct SeriesLeftOut {
  /// The robot has rcan.robot_series_max others.
  std::size_t over_max = 0;
  /// They are new, and rcan.robot_new_names_max others were so lately.
  std::size_t new_names = 0;

  [[nodiscard]] std::size_t all() const { return over_max + new_names; }
};

/// Writes those series of one robot into the page of a scrape that carry a word of the robot's own.
/// A robot has at most rcan.robot_series_max series: what is added first has its place first.
/// Confined to one thread; for one robot of one scrape.
class NamedSeries final {
 public:
  struct Scrape {
    SteadyTime now;
    /// Series of the robot that the page has besides, before the part of it that is at hand.
    std::size_t basic = 0;
  };
  /// `names` is what was kept of the robot since the scrape before. All outlive this.
  NamedSeries(metrics::rcan::SeriesPage& page, SeriesNames& names, const NameRules& rules,
              const Scrape& scrape)
      : page_(page), names_(names), rules_(rules), scrape_(scrape) {}

  /// `values` of `first` and of the series after it, SeriesNames::kOfLabelMax at most; an empty one
  /// has no sample.
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
