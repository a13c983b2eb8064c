#include "tools/uplinkctl/verbs/command_verbs.h"

#include <functional>
#include <memory>
#include <utility>

#include <fmt/core.h>

#include "tools/uplinkctl/ask/robot_names.h"
#include "tools/uplinkctl/verbs/common.h"

namespace uplink::ctl {
namespace {

namespace json = boost::json;

/// What is given to one of the verbs.
struct Request {
  CommonFlags common;
  std::string robot;
  std::string reason;
  std::string note;
  bool no_note = false;
  std::vector<std::string> labels;
  bool remove = false;
  std::string fault;
};
using Shared = std::shared_ptr<Request>;
/// Adds to the body of a command what it has beside the robot.
using Fill = std::function<absl::Status(const Request& request, json::object& body)>;

constexpr const char* kConfigOfCommand =
    "Which server: by its configuration file. If none answers, this is done on its store";

/// Only a server resolves the end of a RURI; its store takes the whole one.
absl::Status WithWayOut(const absl::Status& status, const Request& request) {
  if (!absl::IsUnavailable(status) || request.common.server.config.empty()) return status;
  return absl::UnavailableError(fmt::format(
      "{}. Where no server answers, the store takes the robot's whole RURI in place of {}",
      std::string(status.message()), request.robot));
}

absl::Status Send(const Request& request, const std::string& path, const Fill& fill, Api& api,
                  const Screen& screen) {
  json::object body;
  if (!request.robot.empty()) {
    const absl::StatusOr<std::string> ruri = ResolveRobot(api, request.robot);
    if (!ruri.ok()) return WithWayOut(ruri.status(), request);
    body["ruri"] = *ruri;
  }
  if (absl::Status filled = fill ? fill(request, body) : absl::OkStatus(); !filled.ok()) {
    return filled;
  }
  const absl::StatusOr<json::object> answer = api.Post(path, body);
  if (!answer.ok()) return answer.status();
  screen.print(ObjectText(*answer, request.common.format(), screen));
  return absl::OkStatus();
}

config::Flags& AddVerb(config::Flags& noun, const char* name, const char* about,
                       const std::string& path, const Shared& request, const Fill& fill = {}) {
  const auto work = [request, path, fill](Api& api, const Screen& screen) {
    return Send(*request, path, fill, api, screen);
  };
  return noun.AddCommand(name, about,
                         [request, work] { return WithServer(request->common.server, work); });
}

void AddRobot(config::Flags& verb, Request& request) {
  verb.Add({"ROBOT", "The robot: its RURI, or the end of it", config::Flag::Need::kRequired},
           request.robot, NotEmpty());
}

void AddEnd(config::Flags& verb, Request& request) {
  AddOutputFlags(verb, request.common, false);
  AddServerFlags(verb, request.common.server, kConfigOfCommand);
}

void AddBlock(config::Flags& noun) {
  const auto request = std::make_shared<Request>();
  config::Flags& verb =
      AddVerb(noun, "block", "End a robot's streams, and refuse new ones until it is unblocked",
              "/api/v1/robot/block", request, [](const Request& given, json::object& body) {
                body["reason"] = given.reason;
                return absl::OkStatus();
              });
  AddRobot(verb, *request);
  verb.Add({"--reason", "Why, for operators"}, request->reason);
  AddEnd(verb, *request);
  verb.Example("uplinkctl robots block r17 --reason stolen");
}

void AddPlain(config::Flags& noun, const char* name, const char* about, const char* path,
              const char* example) {
  const auto request = std::make_shared<Request>();
  config::Flags& verb = AddVerb(noun, name, about, path, request);
  AddRobot(verb, *request);
  AddEnd(verb, *request);
  verb.Example(example);
}

void AddNote(config::Flags& noun) {
  const auto request = std::make_shared<Request>();
  config::Flags& verb =
      AddVerb(noun, "note", "Set a robot's labels, which lists filter by, and its note",
              "/api/v1/robot/note", request, [](const Request& given, json::object& body) {
                absl::StatusOr<json::object> labels = LabelsOf(given.labels);
                if (!labels.ok()) return labels.status();
                body["labels"] = *std::move(labels);
                if (!given.note.empty() || given.no_note) body["note"] = given.note;
                return absl::OkStatus();
              });
  AddRobot(verb, *request);
  verb.Add({"--label", "NAME=VALUE; NAME= removes the label (repeatable)"}, request->labels);
  verb.Add({"--note", "A text for operators, in place of the one before"}, request->note);
  verb.AddSwitch({"--no-note", "Remove the note"}, request->no_note);
  verb.AtMostOne({"--note", "--no-note"});
  AddEnd(verb, *request);
  verb.Example("uplinkctl robots note r17 --label site=hall2 --note 'new wheels in May'");
}

void AddAdd(config::Flags& noun) {
  const auto request = std::make_shared<Request>();
  config::Flags& verb =
      AddVerb(noun, "add", "Let a robot come in where identity.registration is closed",
              "/api/v1/robot/add", request, [](const Request& given, json::object& body) {
                body["remove"] = given.remove;
                return absl::OkStatus();
              });
  verb.Add({"RURI", "The robot: rcan://...", config::Flag::Need::kRequired}, request->robot,
           NotEmpty());
  verb.AddSwitch({"--remove", "Take that back: it may not come again once it has left"},
                 request->remove);
  AddEnd(verb, *request);
  verb.Example("uplinkctl robots add rcan://example.org/acme/rover/1.0/r18");
}

}  // namespace

absl::StatusOr<json::object> LabelsOf(const std::vector<std::string>& labels) {
  json::object object;
  for (const std::string& label : labels) {
    const std::size_t equals = label.find('=');
    if (equals == std::string::npos) {
      return absl::InvalidArgumentError(fmt::format("--label {}: write NAME=VALUE", label));
    }
    object[label.substr(0, equals)] = label.substr(equals + 1);
  }
  return object;
}

void AddRobotCommands(config::Flags& noun) {
  AddBlock(noun);
  AddPlain(noun, "unblock", "Let a blocked robot come in again", "/api/v1/robot/unblock",
           "uplinkctl robots unblock r17");
  AddPlain(noun, "disconnect", "End a robot's streams; it may come again at once",
           "/api/v1/robot/disconnect", "uplinkctl robots disconnect r17");
  AddNote(noun);
  AddAdd(noun);
}

void AddFaultCommands(config::Flags& noun) {
  const auto request = std::make_shared<Request>();
  config::Flags& verb =
      AddVerb(noun, "acknowledge", "Note that an active fault was seen, until it is raised again",
              "/api/v1/faults/acknowledge", request, [](const Request& given, json::object& body) {
                body["faultId"] = given.fault;
                body["note"] = given.note;
                return absl::OkStatus();
              });
  AddRobot(verb, *request);
  verb.Add({"FAULT", "The fault's id", config::Flag::Need::kRequired}, request->fault, NotEmpty());
  verb.Add({"--note", "A text for operators"}, request->note);
  AddEnd(verb, *request);
  verb.Example("uplinkctl faults acknowledge r17 brake.worn --note 'ann is on her way'");
}

void AddReload(config::Flags& program) {
  const auto request = std::make_shared<Request>();
  const auto work = [request](Api& api, const Screen& screen) -> absl::Status {
    const absl::StatusOr<json::object> answer = api.Post("/api/v1/reload", {});
    if (!answer.ok()) return answer.status();
    screen.print(ObjectText(*answer, request->common.format(), screen));
    const auto* problems = answer->if_contains("problems");
    if (problems == nullptr || !problems->is_array() || problems->get_array().empty()) {
      return absl::OkStatus();
    }
    return absl::FailedPreconditionError("the configuration has problems: nothing was taken over");
  };
  config::Flags& verb = program.AddCommand(
      "reload",
      "Let a server read its configuration again: what it took over, what needs a restart",
      [request, work] { return WithServer(request->common.server, work); });
  AddOutputFlags(verb, request->common, false);
  AddServerFlags(verb, request->common.server);
  verb.Example("uplinkctl reload");
}

}  // namespace uplink::ctl
