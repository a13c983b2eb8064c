#include "tools/uplink-fleet/compare/verify_twins.h"

#include <algorithm>
#include <array>

#include <fmt/core.h>

namespace uplink::synthetic {
namespace {

constexpr std::array<const char*, 9> kOutcomes = {"stored",    "applied",  "superseded",
                                                  "duplicate", "rejected", "refused",
                                                  "observed",  "ignored",  "blocked"};

std::string Text(std::uint64_t number) { return fmt::format("{}", number); }

std::uint64_t Moved(std::uint64_t after, std::uint64_t before) {
  return after - std::min(after, before);
}

}  // namespace

std::optional<Conservation> SourceCounts::Moved() const {
  if (!after) return std::nullopt;
  const Conservation from = restarted ? Conservation() : before.value_or(Conservation());
  Conservation moved{.received = synthetic::Moved(after->received, from.received),
                     .in_flight = after->in_flight,
                     .settled = {}};
  for (const char* outcome : kOutcomes) {
    moved.settled[outcome] = synthetic::Moved(after->Of(outcome), from.Of(outcome));
  }
  return moved;
}

void CheckCounts(const SourceCounts& counts, std::vector<CheckRow>& rows) {
  const ConservationWatch& watch = counts.watch;
  rows.push_back({"scrapes in which received = the rest", Text(watch.scrapes()), Text(watch.good()),
                  "", watch.scrapes() > 0 && watch.good() == watch.scrapes(), watch.first_wrong()});
  const std::optional<Conservation> moved = counts.Moved();
  if (!moved) {
    rows.push_back({"received = the rest", "", "", "", false, "/metrics does not say"});
    return;
  }
  const Conservation& after = *counts.after;
  rows.push_back({"received = the rest", "", fmt::format("{} = {}", after.received, after.sum()),
                  "", after.holds(), ""});
  rows.push_back(
      {"in flight at the end", "0", Text(after.in_flight), "", after.in_flight == 0, ""});
  for (const char* outcome : kOutcomes) {
    rows.push_back(
        {fmt::format("settled: {}", outcome), "", Text(moved->Of(outcome)), "", true, ""});
  }
}

void TwinTotals::Add(const TwinAccount& account) {
  ++twins;
  if (account.waiting() == 0) ++settled_twins;
  acked += account.acked();
  refused += account.refused();
}

void ConservationWatch::See(const std::optional<Conservation>& counts) {
  ++scrapes_;
  if (counts && counts->holds()) {
    ++good_;
  } else if (first_wrong_.empty()) {
    first_wrong_ =
        counts ? fmt::format("{} received, {} in all other places", counts->received, counts->sum())
               : "/metrics does not say";
  }
}

std::vector<CheckRow> VerifyTwins(const TwinEvidence& evidence) {
  const TwinTotals& totals = evidence.totals;
  std::vector<CheckRow> rows;
  rows.push_back({"twins with all acked", Text(totals.twins), Text(totals.settled_twins), "",
                  totals.settled_twins == totals.twins, ""});
  rows.push_back({"published at QoS 1, acked", Text(totals.published_qos1), Text(totals.acked), "",
                  totals.acked == totals.published_qos1, ""});
  rows.push_back({"refused by the broker", "0", Text(totals.refused), "", totals.refused == 0, ""});
  rows.push_back({"pings answered", Text(totals.pings), Text(totals.pongs), "",
                  totals.pongs > 0 && totals.pongs <= totals.pings, "at QoS 0 some may be lost"});
  CheckCounts(evidence, rows);
  if (const std::optional<Conservation> moved = evidence.Moved()) {
    // After a restart the counters know a part alone.
    rows.push_back({"received, at least what was acked", Text(totals.acked), Text(moved->received),
                    "", evidence.restarted || moved->received >= totals.acked, ""});
  }
  rows.push_back({"twins whose rows were read", Text(totals.twins), "", Text(evidence.twins_read),
                  evidence.twins_read == totals.twins, ""});
  for (std::size_t i = kTwinThings; i < kDroneThings; ++i) {
    rows.push_back(LineOf(static_cast<Thing>(i), evidence.findings));
  }
  return rows;
}

}  // namespace uplink::synthetic
