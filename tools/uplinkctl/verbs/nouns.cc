#include "tools/uplinkctl/verbs/nouns.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "tools/uplinkctl/verbs/command_verbs.h"
#include "tools/uplinkctl/verbs/list_verb.h"
#include "tools/uplinkctl/verbs/records.h"

namespace uplink::ctl {
namespace {

/// What the lists of a noun are of, for the help of the noun. Of one that is not here: what its
/// first list says.
constexpr std::pair<std::string_view, std::string_view> kAbouts[] = {
    {"fleets", "Fleets, each with its robots in figures"},
    {"robots", "Robots: what each is now, what happened to it, who sends most"},
    {"faults", "Faults, now and before"},
    {"missions", "Mission runs and what was reported of them"},
    {"events", "Events that robots reported"},
    {"messages", "Texts that robots wrote for people"},
    {"presence", "When robots came and went"},
    {"shapes", "Areas that robots reported"},
    {"objects", "Objects that robots track"},
    {"gaps", "Numbers that robots skipped"},
    {"connections", "Connections of robots, and why each ended"},
    {"quarantine", "Messages that the server rejected"},
    {"scope-updates", "Cyberwave environments and workflow runs"},
    {"operator-requests", "What drones asked operators to confirm"},
    {"audit", "What operators and the server changed"},
    {"certificates", "Certificates of robots: which expire, which are revoked"},
};

std::string_view AboutOf(const List& first) {
  const auto* const about =
      std::ranges::find(kAbouts, first.noun, &std::pair<std::string_view, std::string_view>::first);
  return about == std::end(kAbouts) ? first.about : about->second;
}

}  // namespace

void AddQuestions(config::Flags& program) {
  AddStatus(program);
  std::map<std::string_view, config::Flags*> nouns;
  for (const List& list : Lists()) {
    config::Flags*& noun = nouns[list.noun];
    if (noun == nullptr) {
      noun = &program.AddCommand(std::string(list.noun), std::string(AboutOf(list)));
    }
    AddList(*noun, list);
  }
  AddRobotsGet(*nouns.at("robots"));
  AddMissionsShow(*nouns.at("missions"));
  AddQuarantineShow(*nouns.at("quarantine"));
  AddRobotCommands(*nouns.at("robots"));
  AddFaultCommands(*nouns.at("faults"));
  AddCertificateCommands(*nouns.at("certificates"));
  AddReload(program);
}

}  // namespace uplink::ctl
