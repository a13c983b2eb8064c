#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/json.hpp>

namespace uplink::test {

/// Where operators see a conformance vector, and what they see there. Made from the vector's JSON
/// file and from nothing of ours, so that it can judge our rendering. A value.
struct VectorView {
  /// What to GET.
  std::string target;
  /// The member of the answer that holds the rows; empty: the answer is a Robot.
  std::string list;
  /// The one row that must be there; nothing: no row may be. Of a Robot: the one part that it must
  /// carry, under its name, or nothing.
  std::optional<boost::json::object> row;
  /// Further members of the row: times of the server.
  std::vector<std::string> times;
};

/// Every place where a vector is seen whose robot sent it once and nothing else. `vector` is the
/// text of its JSON file.
[[nodiscard]] std::vector<VectorView> ViewsOf(const std::string& ruri, std::string_view vector);

/// The vector's robot: one for each name.
[[nodiscard]] std::string RuriOfVector(std::string_view name);

/// Unix milliseconds, both inclusive.
struct TimeSpan {
  std::int64_t from_ms = 0;
  std::int64_t to_ms = 0;
};

/// What differs between an answer's body and `view`; empty if nothing. Server times must lie in
/// `arrival`; members that `view` does not name are a difference.
[[nodiscard]] std::string Difference(const VectorView& view, std::string_view answer,
                                     const TimeSpan& arrival);

}  // namespace uplink::test
