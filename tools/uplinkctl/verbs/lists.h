#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tools/uplinkctl/ask/api.h"
#include "tools/uplinkctl/show/columns.h"

namespace uplink::ctl {

/// Rows that --limit may ask for.
inline constexpr int kLimitMax = 1'000'000;

/// A flag of a list that becomes a parameter of its request. A value.
struct Filter {
  enum class Kind : std::uint8_t {
    kText,
    /// A switch: the parameter is `true` if it is given.
    kSwitch,
    /// A switch: the parameter is `true` unless it is given.
    kUnless,
    /// A time, or how long before now it was.
    kBefore,
    /// How long after now a time is.
    kWithin,
  };

  std::string_view flag;
  std::string_view parameter;
  std::string_view about;
  Kind kind = Kind::kText;
  std::vector<std::string> choices = {};
};

/// One list of the API as a verb: `uplinkctl events list`. A value.
struct List {
  std::string_view noun;
  std::string_view verb = "list";
  std::string_view about;
  std::string_view path;
  /// Of the answer, with the rows.
  std::string_view member;
  Columns columns;
  std::vector<Filter> filters = {};
  /// Parameters that each request has.
  Query fixed = {};
  std::vector<std::string_view> examples;
  /// It takes --fleet.
  bool of_fleet = true;
  /// It takes --robot.
  bool of_robots = true;
  /// It takes --since, --until and --oldest.
  bool in_time = true;
  /// The store of --config answers where no server does.
  bool of_store = false;
  /// A robot must be named, by position.
  bool of_one_robot = false;
  /// The member by which its rows are in order, if a row that is there stays as it is: --follow
  /// adds new rows below. Of others it shows the whole list again.
  std::string_view grows_by = {};
  /// Rows that are shown without --limit.
  int limit = 100;
  int limit_max = kLimitMax;
};

/// Every list that uplinkctl shows.
[[nodiscard]] std::vector<List> Lists();

}  // namespace uplink::ctl
