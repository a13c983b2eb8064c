#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <boost/json.hpp>

#include "schema/base/clock.h"
#include "tools/uplinkctl/show/table.h"

namespace uplink::ctl {

/// How a member of a row is shown in a table. Closed.
enum class Kind : std::uint8_t {
  kText,
  /// A word with a tone: `offline`, `critical`.
  kWord,
  /// A RURI, as short as it is unique.
  kRobot,
  /// A time, as its distance from now.
  kAge,
  /// A time as the clock showed it, to the second, in UTC.
  kTime,
  /// Two times with a comma between their names: how long it took.
  kLength,
  kNumber,
  /// A number with one digit behind the point.
  kRate,
  /// Hundredths of a percent, as whole percent.
  kHundredths,
  /// A number of bytes.
  kBytes,
  /// `yes` if it is true, empty otherwise.
  kYes,
  /// A list of texts, or numbers by name, with commas.
  kList,
  /// Latitude and longitude, or x and y.
  kPlace,
  /// A number of percent, which is bad when it is low.
  kPercent,
};

/// A column of a table. CSV has a column for each member, which shows it as JSON has it. A value.
struct Column {
  std::string_view title;
  /// Names with points between them: `backlog.uplinks`.
  std::string_view member;
  Kind kind = Kind::kText;
  Fit fit = Fit::kKeep;
};
using Columns = std::vector<Column>;

/// Short names by RURI (show/short_names.h).
using ShortNames = std::map<std::string, std::string>;

struct ColumnTerms {
  SystemTime now;
  const ShortNames& names;
};

/// The member at a path; null if it is not there.
[[nodiscard]] const boost::json::value* MemberAt(const boost::json::object& row,
                                                 std::string_view path);
/// The text at a path; empty for what is no text.
[[nodiscard]] std::string TextAt(const boost::json::object& row, std::string_view path);

[[nodiscard]] Heading HeadingOf(const Column& column);
/// For a table: one line, printable.
[[nodiscard]] Cell CellOf(const Column& column, const boost::json::object& row,
                          const ColumnTerms& terms);

/// How good or bad a word of the server is: `offline` is bad.
[[nodiscard]] Tone ToneOf(std::string_view word);

/// `64 B`, `1.5 KiB`, `3.0 GiB`.
[[nodiscard]] std::string SizeText(double bytes);
/// `1,234,567`.
[[nodiscard]] std::string CountText(std::string_view digits);

}  // namespace uplink::ctl
