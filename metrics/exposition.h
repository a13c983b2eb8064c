#pragma once

#include <array>
#include <chrono>
#include <concepts>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "metrics/catalogue.h"
#include "metrics/cells.h"
#include "metrics/format.h"
#include "metrics/ledger.h"

namespace uplink::metrics {

/// One scrape under construction: samples of catalogue entries, then the text. Each entry is
/// written in the catalogue's order, whatever the order of the calls; one without a sample is left
/// out.
///
/// Limits:  label values are the caller's: only closed sets and bounded lists of fleets, never a
///          robot's.
/// Thread:  confined to one thread.
class Exposition final {
 public:
  Exposition();
  ~Exposition();
  Exposition(const Exposition&) = delete;
  Exposition& operator=(const Exposition&) = delete;

  /// A sample of a counter or gauge; `labels` are the values in the order of the entry's names.
  void Add(MetricId id, double value, std::initializer_list<std::string_view> labels = {});
  template <std::integral Number>
  void Add(MetricId id, Number value, std::initializer_list<std::string_view> labels = {}) {
    Add(id, static_cast<double>(value), labels);
  }
  /// In seconds.
  void Add(MetricId id, std::chrono::milliseconds duration) {
    Add(id, static_cast<double>(duration.count()) / 1e3);
  }
  void Add(MetricId id, const Cell& cell, std::initializer_list<std::string_view> labels = {}) {
    Add(id, cell.value(), labels);
  }
  void Add(MetricId id, const CoreCell& cell, std::initializer_list<std::string_view> labels = {}) {
    Add(id, cell.value(), labels);
  }

  template <std::size_t kBuckets>
  void Add(MetricId id, const Distribution<kBuckets>& distribution,
           std::initializer_list<std::string_view> labels = {}) {
    std::array<std::uint64_t, kBuckets + 1> counts{};
    for (std::size_t i = 0; i <= kBuckets; ++i) counts[i] = distribution.count(i);
    AddHistogram(id, distribution.upper_bounds(), counts, distribution.sum(), labels);
  }

  /// All samples that come from the ledgers: what belongs together is taken from one sum.
  void AddLedger(const Ledger::Page& sum);
  /// The ages of the messages of each source.
  void AddAges(const LedgerBook& book);

  [[nodiscard]] std::string Text(Format format = Format::kText) const;

 private:
  struct Families;

  void AddHistogram(MetricId id, std::span<const double> bounds,
                    std::span<const std::uint64_t> counts, double sum,
                    std::initializer_list<std::string_view> labels);

  std::unique_ptr<Families> families_;
};

/// Adds the samples of one component to a page, read from its probe. Any thread.
using PageSource = std::function<void(Exposition&)>;

/// The text of one scrape: a page to which each of the sources adds its samples, in their order.
[[nodiscard]] std::string PageText(std::span<const PageSource> sources, Format format);

}  // namespace uplink::metrics
