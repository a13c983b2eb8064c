#include "server/robot/source_of.h"

#include "schema/base/check.h"
#include "schema/cyberwave/ruri.h"
#include "storage/origin.h"

namespace uplink::robot {
namespace {

/// Whether only robots of this source have such a RURI.
bool Owns(model::MessageSource source, std::string_view ruri) {
  switch (source) {
    case model::MessageSource::kUplink:
      return false;
    case model::MessageSource::kCyberwave:
      return cyberwave::IsTwinRuri(ruri) || storage::IsNoRobot(ruri);
    case model::MessageSource::kUncrew:
      return false;  // a drone may relay, too
  }
  CheckFailed(__FILE__, __LINE__, "source", "a source that does not exist");
}

}  // namespace

model::MessageSource SourceOf(std::string_view ruri) {
  for (const model::MessageSource source : model::kAllMessageSources) {
    if (Owns(source, ruri)) return source;
  }
  return model::MessageSource::kUplink;
}

}  // namespace uplink::robot
