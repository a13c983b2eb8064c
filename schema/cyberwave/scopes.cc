#include <string_view>

#include "schema/cyberwave/detail.h"
#include "schema/cyberwave/families.h"
#include "schema/limits.h"
#include "schema/rules/describe.h"

namespace uplink::cyberwave {

using model::cyberwave::ScopeKind;
using model::cyberwave::ScopeUpdate;
using schema::Path;

ScopeUpdate ReadEnvironment(Reader& in, boost::json::object& object, std::string_view type) {
  ScopeUpdate update;
  update.scope = ScopeKind::kEnvironment;
  update.type = in.Text("type", schema::kNameBytesMax, Need::kMust);
  const boost::json::value* said = in.Find("type");
  if (said != nullptr && said->is_string() && FromBoost(said->get_string()) != type) {
    const Path field = in.path().Field("type");
    in.violations().Reject(schema::TopicMismatch(field, update.type, type));
  }
  const bool bound = in.Find("data") == nullptr && in.Find("bindings") != nullptr;
  if (!bound) (void)in.Object("data", Need::kMust);
  update.detail = DetailOf(object, in.violations());
  return update;
}

ScopeUpdate ReadWorkflowRun(Reader& in, boost::json::object& object) {
  ScopeUpdate update;
  update.scope = ScopeKind::kWorkflowRun;
  update.type = in.Text("status", schema::kNameBytesMax, Need::kMust);
  update.detail = DetailOf(object, in.violations());
  return update;
}

}  // namespace uplink::cyberwave
