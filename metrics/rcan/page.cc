#include "metrics/rcan/page.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "metrics/format.h"

namespace uplink::metrics::rcan {
namespace {

/// Below it a double that is whole is written as an integer, which people read more easily.
constexpr double kWholeBelow = 1e15;
/// More than any double or 64-bit integer takes.
constexpr std::size_t kNumberBytes = 32;
/// Memory that holds more than so many times what it is used for is given back.
constexpr std::size_t kSlackMax = 4;

}  // namespace

SeriesPage::SeriesPage(const Options& options) : series_max_(options.series_max) {
  for (const SeriesSpec& spec : AllSeries()) {
    const std::string name = ShortName(spec, options.subsystem);
    names_[Index(spec.id)] = FullName(spec, options.subsystem);
    written_[Index(spec.id)] =
        options.fields.empty() || std::ranges::find(options.fields, name) != options.fields.end();
  }
}

void SeriesPage::Clear() {
  for (std::string& lines : lines_) {
    if (lines.capacity() > kSlackMax * std::max<std::size_t>(lines.size(), 1024)) {
      lines.shrink_to_fit();
    }
    lines.clear();
  }
  samples_ = 0;
  samples_before_ = 0;
  room_ = 0;
}

void SeriesPage::BeginRobot(std::string_view ruri) {
  ruri_.assign("ruri=\"");
  AppendEscaped(ruri_, ruri);
  ruri_ += "\"} ";
  for (std::size_t i = 0; i < kSeries; ++i) lines_before_[i] = lines_[i].size();
  samples_before_ = samples_;
}

void SeriesPage::AppendValue(std::string& lines, double value) {
  std::array<char, kNumberBytes> text;  // NOLINT(*-member-init): written before it is read
  const bool whole = std::trunc(value) == value && std::abs(value) < kWholeBelow;
  const auto end = whole ? std::to_chars(text.begin(), text.end(), static_cast<std::int64_t>(value))
                         : std::to_chars(text.begin(), text.end(), value);
  lines.append(text.data(), end.ptr);
  lines += '\n';
  ++samples_;
}

void SeriesPage::Add(SeriesId id, double value) {
  const std::size_t i = Index(id);
  if (!written_[i]) return;
  lines_[i].append(names_[i]).append("{").append(ruri_);
  AppendValue(lines_[i], value);
}

void SeriesPage::Add(SeriesId id, std::span<const std::string_view> labels, double value) {
  const std::size_t i = Index(id);
  if (!written_[i]) return;
  std::string_view names = AllSeries()[i].label;
  lines_[i].append(names_[i]).append("{");
  for (const std::string_view label : labels) {
    lines_[i].append(TakeLabel(names)).append("=\"");
    AppendEscaped(lines_[i], label);
    lines_[i].append("\",");
  }
  lines_[i].append(ruri_);
  AppendValue(lines_[i], value);
}

bool SeriesPage::EndRobot(std::size_t room) {
  const std::size_t needed = std::max(room, robot_samples());
  if (room_ + needed <= series_max_) {
    room_ += needed;
    return true;
  }
  for (std::size_t i = 0; i < kSeries; ++i) lines_[i].resize(lines_before_[i]);
  samples_ = samples_before_;
  return false;
}

void SeriesPage::Write(Format format, std::string& text) const {
  std::size_t bytes = 0;
  for (const std::string& lines : lines_) bytes += lines.size();
  if (text.capacity() > kSlackMax * std::max<std::size_t>(bytes, 1024)) std::string().swap(text);
  text.clear();
  for (std::size_t i = 0; i < kSeries; ++i) {
    if (lines_[i].empty()) continue;
    text.append("# HELP ").append(names_[i]).append(" ").append(AllSeries()[i].help).append("\n");
    text.append("# TYPE ").append(names_[i]).append(" gauge\n").append(lines_[i]);
  }
  if (format == Format::kOpenMetrics) text += "# EOF\n";
}

}  // namespace uplink::metrics::rcan
