#pragma once

#include <array>

#include "metrics/catalogue.h"
#include "metrics/catalogue_labels.h"

// What is counted of drones' calls: the last part of the catalogue, for catalogue.cc alone.
namespace uplink::metrics {

inline constexpr auto kUncrewSpecs = std::to_array<MetricSpec>({
    {MetricId::kAvatarPublishes, "uplinkd_avatar_publishes_total", MetricType::kCounter, "calls",
     "Calls by which drones published, by type and outcome.", kByTypeOutcome},
    {MetricId::kAvatarAnswerSeconds, "uplinkd_avatar_answer_seconds", MetricType::kHistogram,
     "seconds",
     "From a drone's sample to its answer, of live samples and of those that are stored first.",
     kByKind},
    {MetricId::kAvatarDrones, "uplinkd_avatar_drones", MetricType::kGauge, "robots",
     "Drones that called this server within the last day."},
    {MetricId::kOperatorRequestsOpen, "uplinkd_operator_requests_open", MetricType::kGauge,
     "requests", "Requests of drones that wait for an operator, as the drones last said."},
    {MetricId::kOperatorRequestOldest, "uplinkd_operator_request_oldest_seconds",
     MetricType::kGauge, "seconds",
     "How long the oldest of them has waited here; 0 if none waits."},
});

}  // namespace uplink::metrics
