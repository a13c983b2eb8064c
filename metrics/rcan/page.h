#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "metrics/format.h"
#include "metrics/rcan/series.h"

namespace uplink::metrics::rcan {

/// One scrape of robots' series under construction, robot by robot; the memory is used again from
/// scrape to scrape.
///
/// Limits:  `series_max` samples, whole robots at a time.
/// Thread:  confined to one thread.
class SeriesPage final {
 public:
  struct Options {
    /// The second word of the joints' series.
    std::string subsystem{kSubsystemDefault};
    /// Short names of the series that are written; empty: all.
    std::vector<std::string> fields;
    std::size_t series_max = 0;
  };
  explicit SeriesPage(const Options& options);

  /// Forgets the scrape before.
  void Clear();

  void BeginRobot(std::string_view ruri);
  /// Whether samples of that series are kept.
  [[nodiscard]] bool Writes(SeriesId id) const { return written_[Index(id)]; }
  /// A sample of the present robot. One that would not be written is dropped.
  void Add(SeriesId id, double value);
  /// `label` is the value of the series' own label, whatever its bytes.
  void Add(SeriesId id, std::string_view label, double value) {
    Add(id, std::span(&label, 1), value);
  }
  /// The values of all the series' own labels, in the order of its entry.
  void Add(SeriesId id, std::span<const std::string_view> labels, double value);
  /// The robot at hand has a sample of that series.
  [[nodiscard]] bool Has(SeriesId id) const {
    return lines_[Index(id)].size() > lines_before_[Index(id)];
  }
  /// Samples of the robot at hand so far.
  [[nodiscard]] std::size_t robot_samples() const { return samples_ - samples_before_; }
  /// Whether the robot stays: not if the room of all that stay would be more than series_max. A
  /// robot's room is its samples, or `room` if that is more.
  bool EndRobot(std::size_t room = 0);

  /// Samples of the robots that stayed.
  [[nodiscard]] std::size_t samples() const { return samples_; }

  /// The whole text, in place of what `text` holds.
  void Write(Format format, std::string& text) const;

 private:
  static std::size_t Index(SeriesId id) { return static_cast<std::size_t>(id); }
  void AppendValue(std::string& lines, double value);

  const std::size_t series_max_;
  /// `rcan_acb_position_rad`, by SeriesId.
  std::array<std::string, kSeries> names_;
  std::array<bool, kSeries> written_{};
  /// Samples by SeriesId: a series' samples stand together in the text.
  std::array<std::string, kSeries> lines_;
  /// Of the robot at hand: `ruri="..."} `.
  std::string ruri_;
  std::array<std::size_t, kSeries> lines_before_{};
  std::size_t samples_ = 0;
  std::size_t samples_before_ = 0;
  /// The room of the robots that stayed.
  std::size_t room_ = 0;
};

}  // namespace uplink::metrics::rcan
