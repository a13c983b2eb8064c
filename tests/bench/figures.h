#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace uplink::bench {

/// The value below which so much of them lies (`share` of 0.99: the 99th percentile); 0 of none.
[[nodiscard]] double Quantile(std::vector<double> values, double share);

/// What several rounds of one scenario measured, in the scenario's unit.
class Rounds final {
 public:
  void Add(double value) { values_.push_back(value); }

  [[nodiscard]] double median() const {
    std::vector<double> sorted = values_;
    std::ranges::sort(sorted);
    return sorted.empty() ? 0 : sorted[sorted.size() / 2];
  }
  /// Half of the distance between the least and the most, as a share of the median.
  [[nodiscard]] double spread() const {
    if (values_.empty() || median() == 0) return 0;
    const auto [least, most] = std::ranges::minmax(values_);
    return (most - least) / 2 / median();
  }

 private:
  std::vector<double> values_;
};

/// One line of a benchmark: a figure beside its comparator's, measured in the same run.
struct Row {
  std::string scenario;
  std::string unit;
  std::string comparator;
  Rounds value;
  Rounds comparator_value;

  [[nodiscard]] double ratio() const {
    const double base = comparator_value.median();
    return base == 0 ? 0 : value.median() / base;
  }
};

/// A figure that has no comparator and came once.
[[nodiscard]] Row RowOf(std::string scenario, std::string unit, double value);

/// The rows as a table for people.
[[nodiscard]] std::string TableOf(const std::vector<Row>& rows);
/// `{"machine":{...},"commit":"...","rows":[...]}`.
[[nodiscard]] std::string JsonOf(const std::vector<Row>& rows, const std::string& commit);
/// The same as a file; none if `path` is empty. False if it cannot be written, which it says.
[[nodiscard]] bool KeepJson(const std::string& path, const std::vector<Row>& rows,
                            const std::string& commit);

}  // namespace uplink::bench
