#include "tools/uplink-fleet/compare/verify_twins.h"

#include <algorithm>
#include <array>

#include <fmt/core.h>

namespace uplink::synthetic {
namespace {

constexpr std::array<const char*, 8> kOutcomes = {"stored",   "applied", "superseded", "duplicate",
                                                  "rejected", "refused", "observed",   "ignored"};

std::string Text(std::uint64_t number) { return fmt::format("{}", number); }

std::uint64_t Moved(std::uint64_t after, std::uint64_t before) {
  return after - std::min(after, before);
}

void CheckCounts(const TwinEvidence& evidence, std::vector<CheckRow>& rows) {
  const ConservationWatch& watch = evidence.watch;
  rows.push_back({"scrapes in which received = the rest", Text(watch.scrapes()), Text(watch.good()),
                  "", watch.scrapes() > 0 && watch.good() == watch.scrapes(), watch.first_wrong()});
  if (!evidence.after) {
    rows.push_back({"received = the rest", "", "", "", false, "/metrics does not say"});
    return;
  }
  const Conservation& after = *evidence.after;
  rows.push_back({"received = the rest", "", fmt::format("{} = {}", after.received, after.sum()),
                  "", after.holds(), ""});
  rows.push_back(
      {"in flight at the end", "0", Text(after.in_flight), "", after.in_flight == 0, ""});
  const Conservation before =
      evidence.restarted ? Conservation() : evidence.before.value_or(Conservation());
  const std::uint64_t received = Moved(after.received, before.received);
  // After a restart the counters know a part alone.
  rows.push_back({"received, at least what was acked", Text(evidence.totals.acked), Text(received),
                  "", evidence.restarted || received >= evidence.totals.acked, ""});
  for (const char* outcome : kOutcomes) {
    rows.push_back({fmt::format("settled: {}", outcome), "",
                    Text(Moved(after.Of(outcome), before.Of(outcome))), "", true, ""});
  }
}

}  // namespace

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
  rows.push_back({"twins whose rows were read", Text(totals.twins), "", Text(evidence.twins_read),
                  evidence.twins_read == totals.twins, ""});
  for (std::size_t i = kTwinThings; i < kThings; ++i) {
    rows.push_back(LineOf(static_cast<Thing>(i), evidence.findings));
  }
  return rows;
}

}  // namespace uplink::synthetic
