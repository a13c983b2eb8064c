#include "metrics/exposition.h"

#include <limits>
#include <sstream>
#include <utility>
#include <vector>

#include <prometheus/metric_family.h>
#include <prometheus/text_serializer.h>

#include "metrics/kinds.h"
#include "metrics/openmetrics.h"
#include "schema/base/check.h"
#include "schema/model/rejection.h"
#include "schema/model/variants.h"

namespace uplink::metrics {
namespace {

prometheus::MetricType TypeOf(MetricType type) {
  switch (type) {
    case MetricType::kCounter:
      return prometheus::MetricType::Counter;
    case MetricType::kGauge:
      return prometheus::MetricType::Gauge;
    case MetricType::kHistogram:
      return prometheus::MetricType::Histogram;
  }
  return prometheus::MetricType::Untyped;
}

double Number(std::uint64_t value) { return static_cast<double>(value); }

}  // namespace

struct Exposition::Families {
  std::array<prometheus::MetricFamily, kMetrics> by_id;

  /// `labels` are the values in the order of the entry's names.
  prometheus::ClientMetric& NewSample(MetricId id, std::initializer_list<std::string_view> labels) {
    const MetricSpec& spec = SpecOf(id);
    UPLINK_CHECK(spec.labels.size() == labels.size(), "a sample has the labels of its entry");
    prometheus::MetricFamily& family = by_id[static_cast<std::size_t>(id)];
    if (family.metric.empty()) {
      family.name = spec.name;
      family.help = spec.help;
      family.type = TypeOf(spec.type);
    }
    prometheus::ClientMetric& sample = family.metric.emplace_back();
    std::size_t i = 0;
    for (const std::string_view label : labels) {
      sample.label.push_back({std::string(spec.labels[i++]), std::string(label)});
    }
    return sample;
  }
};

Exposition::Exposition() : families_(std::make_unique<Families>()) {}
Exposition::~Exposition() = default;

void Exposition::Add(MetricId id, double value, std::initializer_list<std::string_view> labels) {
  UPLINK_CHECK(SpecOf(id).type != MetricType::kHistogram, "a histogram is added whole");
  prometheus::ClientMetric& sample = families_->NewSample(id, labels);
  // The serializer reads the one that belongs to the family's type.
  sample.counter.value = value;
  sample.gauge.value = value;
}

void Exposition::AddHistogram(MetricId id, std::span<const double> bounds,
                              std::span<const std::uint64_t> counts, double sum,
                              std::initializer_list<std::string_view> labels) {
  UPLINK_CHECK(SpecOf(id).type == MetricType::kHistogram, "a distribution belongs to a histogram");
  prometheus::ClientMetric::Histogram& histogram = families_->NewSample(id, labels).histogram;
  std::uint64_t cumulative = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    cumulative += counts[i];
    const double bound = i < bounds.size() ? bounds[i] : std::numeric_limits<double>::infinity();
    histogram.bucket.push_back({cumulative, bound});
  }
  histogram.sample_count = cumulative;
  histogram.sample_sum = sum;
}

void Exposition::AddLedger(const Ledger::Page& sum) {
  const MessageCounts& uplinks = sum.messages;
  Add(MetricId::kUplinksReceived, Number(uplinks.received));
  Add(MetricId::kUplinksSettled, Number(uplinks.stored), {"stored"});
  Add(MetricId::kUplinksSettled, Number(uplinks.applied), {"applied"});
  Add(MetricId::kUplinksSettled, Number(uplinks.superseded), {"superseded"});
  Add(MetricId::kUplinksSettled, Number(uplinks.duplicate), {"duplicate"});
  Add(MetricId::kUplinksSettled, Number(uplinks.rejected), {"rejected"});
  Add(MetricId::kUplinksInFlight, static_cast<double>(uplinks.in_flight));
  Add(MetricId::kUplinksMissing, Number(uplinks.missing));
  for (const model::RejectReason reason : model::kAllRejectReasons) {
    const auto index = static_cast<std::size_t>(reason);
    Add(MetricId::kRejects, Number(uplinks.rejects[index]), {model::ToText(reason)});
  }
  for (std::size_t kind = 0; kind < kKinds; ++kind) {
    const std::string_view name = KindText(kind);
    const bool rcan = kind == kRcanKind;
    Add(MetricId::kRecords, Number(rcan ? uplinks.rcan_states : uplinks.records[kind]), {name});
    if (!rcan && model::IsDurable(static_cast<model::Variant>(kind))) continue;
    for (const model::RejectReason reason : model::kAllRejectReasons) {
      Add(MetricId::kFieldsDropped, Number(sum.dropped[kind][static_cast<std::size_t>(reason)]),
          {name, model::ToText(reason)});
    }
  }
  for (std::size_t kind = 0; kind <= kUnknownKind; ++kind) {
    for (const model::RejectReason reason : model::kAllRejectReasons) {
      const auto index = static_cast<std::size_t>(reason);
      Add(MetricId::kRejectsJudged, Number(sum.rejected_kinds[kind][index]),
          {KindText(kind), model::ToText(reason)});
    }
  }
  Add(MetricId::kRcanStatesMissing, Number(uplinks.rcan_missing));
  Add(MetricId::kTimesUnknown, Number(sum.odd.times_unknown));
  Add(MetricId::kEnumerantsUnrecognized, Number(sum.odd.enumerants_unrecognized));
  Add(MetricId::kControlCharacters, Number(sum.odd.control_characters));
}

void Exposition::AddAges(const LedgerBook& book) {
  for (const model::MessageSource source : model::kAllMessageSources) {
    const MessageAges ages = book.Sum(source).ages;
    for (std::size_t kind = 0; kind < ages.size(); ++kind) {
      AddHistogram(MetricId::kMessageAgeSeconds, kAgeBoundsSeconds, ages[kind].counts,
                   ages[kind].sum_seconds, {ToText(source), kAgeKinds[kind]});
    }
  }
}

std::string Exposition::Text(Format format) const {
  std::vector<prometheus::MetricFamily> families;
  families.reserve(kMetrics);
  for (const prometheus::MetricFamily& family : families_->by_id) {
    if (!family.metric.empty()) families.push_back(family);
  }
  if (format == Format::kOpenMetrics) return OpenMetricsText(families);
  std::ostringstream out;
  prometheus::TextSerializer().Serialize(out, families);
  return std::move(out).str();
}

std::string PageText(std::span<const PageSource> sources, Format format) {
  Exposition page;
  for (const PageSource& add_to : sources) add_to(page);
  return page.Text(format);
}

}  // namespace uplink::metrics
