#include <memory>
#include <string>

#include "tools/uplinkctl/ask/robot_names.h"
#include "tools/uplinkctl/verbs/records.h"

namespace uplink::ctl {

void AddRobotsGet(config::Flags& noun) {
  struct Request {
    CommonFlags common;
    std::string robot;
  };
  const auto request = std::make_shared<Request>();
  const auto work = [request](Api& api, const Screen& screen) -> absl::Status {
    const absl::StatusOr<std::string> ruri = ResolveRobot(api, request->robot);
    if (!ruri.ok()) return ruri.status();
    return ShowAgain(screen, request->common.follow, [&]() -> absl::StatusOr<std::string> {
      const auto robot = api.Get("/api/v1/robot", {{"ruri", *ruri}});
      if (!robot.ok()) return robot.status();
      return ObjectText(*robot, request->common.format(), screen);
    });
  };
  config::Flags& verb =
      noun.AddCommand("get", "Show a robot with all that it reported of itself",
                      [request, work] { return WithServer(request->common.server, work); });
  verb.Add({"ROBOT", "The robot: its RURI, or the end of it", config::Flag::Need::kRequired},
           request->robot);
  AddOutputFlags(verb, request->common, true);
  AddServerFlags(verb, request->common.server);
  verb.Example("uplinkctl robots get r17");
  verb.Example("uplinkctl robots get rcan://example.org/acme/rover/1.0/r17 -o json");
}

}  // namespace uplink::ctl
