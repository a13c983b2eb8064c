#include "server/config/version.h"
#include "tools/uplinkctl/command.h"
#include "tools/uplinkctl/verbs/nouns.h"

namespace uplink::ctl {

namespace {

int Run(int argc, char** argv) {
  config::Flags program("Operate uplinkd and look into it", "uplinkctl", config::VersionText());
  program.Example("uplinkctl status");
  program.Example("uplinkctl robots list --presence offline");
  program.Example("uplinkctl robots story r17 --since 2h");
  program.Example("uplinkctl store forget --help");
  AddQuestions(program);
  AddContexts(program);
  AddHealth(program);
  AddDoctor(program);
  AddConfig(program);
  AddStore(program);
  AddPki(program);
  AddTokens(program);
  return program.Parse(argc, argv).value_or(kExitWrongUse);
}

}  // namespace
}  // namespace uplink::ctl

int main(int argc, char** argv) { return uplink::ctl::Run(argc, argv); }
