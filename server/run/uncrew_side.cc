#include "server/run/uncrew_side.h"

#include "server/uncrew/avatar_methods.h"
#include "server/uncrew/samples.h"

namespace uplink::run {

UncrewSide::UncrewSide(const Context& context)
    : context_(context),
      drones_({.clock = context.clock,
               .fleet = context.fleet,
               .journals = context.journals,
               .ledger = context.ledgers.NewPage(model::MessageSource::kUncrew),
               .seed = context.seed}) {}

transport::MethodsMaker UncrewSide::Methods() {
  const config::Config& config = context_.config;
  if (!config.uncrew.avatar) return {};
  return uncrew::AvatarMethods({.watch = context_.clock,
                                .drones = drones_,
                                .fleet = context_.fleet,
                                .probe = probe_,
                                .ledgers = context_.ledgers,
                                .allowances = context_.allowances,
                                .answer_within = config.uncrew.answer_within,
                                .ruri_template = config.uncrew.ruri_template,
                                .in_flight_max = config.limits.in_flight_uplinks_max,
                                .payload_bytes_max = config.limits.payload_bytes_max,
                                .reports = &context_.reports});
}

void UncrewSide::AddSamples(metrics::Exposition& page) const {
  if (!context_.config.uncrew.avatar) return;
  uncrew::AddSamples(drones_, probe_, context_.clock.Steady(), page);
}

}  // namespace uplink::run
