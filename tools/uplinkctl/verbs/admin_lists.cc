// Lists of what operators decided.
#include "tools/uplinkctl/verbs/list_tables.h"

namespace uplink::ctl {
namespace {

List Audit() {
  return {.noun = "audit",
          .about = "List what operators and the server changed, or tried to",
          .path = "/api/v1/audit",
          .member = "audit",
          .columns = {{"TIME", "at", Kind::kTime},
                      {"AGO", "at", Kind::kAge, Fit::kDrop},
                      {"WHO", "who", Kind::kText, Fit::kShrink},
                      {"PROOF", "proof", Kind::kText, Fit::kDrop},
                      {"FROM", "from", Kind::kText, Fit::kDrop},
                      {"ACTION", "action", Kind::kText},
                      {"TARGET", "target", Kind::kText, Fit::kShrink},
                      {"OUTCOME", "outcome", Kind::kText},
                      {"DETAIL", "detail", Kind::kText, Fit::kShrink}},
          .filters = {{"--who", "who", "Only what this token, certificate or user did"},
                      {"--action", "action", "Only this: robot_block"},
                      {"--target", "target", "Only what was about this RURI, certificate or key"}},
          .examples = {"uplinkctl audit list --since 24h",
                       "uplinkctl audit list --action certificate_revoke"},
          .of_fleet = false,
          .of_robots = false,
          .of_store = true,
          .grows_by = "at"};
}

List Revoked() {
  return {.noun = "certificates",
          .verb = "revoked",
          .about = "List certificates and keys that are revoked",
          .path = "/api/v1/certificates/revocations",
          .member = "revocations",
          .columns = {{"SINCE", "at", Kind::kAge},
                      {"BY", "by", Kind::kText},
                      {"REASON", "reason", Kind::kText, Fit::kShrink},
                      {"KEY SHA-256", "keySha256", Kind::kText},
                      {"SHA-256", "sha256", Kind::kText},
                      {"SERIAL", "serial", Kind::kText},
                      {"ISSUER", "issuer", Kind::kText, Fit::kShrink}},
          .examples = {"uplinkctl certificates revoked"},
          .of_fleet = false,
          .of_robots = false,
          .in_time = false,
          .of_store = true,
          .limit = 1000};
}

}  // namespace

std::vector<List> AdminLists() { return {Audit(), Revoked()}; }

}  // namespace uplink::ctl
