#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <absl/status/statusor.h>
#include <fmt/core.h>

#include "tools/pki/authority.h"
#include "tools/pki/directory.h"
#include "tools/pki/profile.h"
#include "tools/uplinkctl/command.h"

namespace uplink::ctl {
namespace {

/// Robots that one call makes; file names carry four digits or more.
constexpr int kCountMax = 100'000;
constexpr const char* kRuriPrefixDefault = "rcan://local.rcan/uplink/synthetic/1.0";

/// What the verbs share, and what each adds. Lives as long as its verb's closure.
struct Request {
  std::string directory = "./pki";
  std::string name;
  std::string fleet = "default";
  int days = pki::kDaysDefault;
  bool force = false;
  std::vector<std::string> hosts;
  std::vector<std::string> ruris;
  std::string role = "viewer";
  int count = 0;

  [[nodiscard]] pki::Existing existing() const {
    return force ? pki::Existing::kReplace : pki::Existing::kRefuse;
  }
};
using SharedRequest = std::shared_ptr<Request>;

absl::Status Report(const pki::Directory& directory, const std::string& name,
                    const absl::Status& written) {
  if (written.ok()) {
    fmt::print("{} {}\n", directory.CertificatePath(name), directory.KeyPath(name));
  }
  return written;
}

absl::Status Init(const Request& request) {
  const pki::Directory directory(request.directory);
  if (absl::Status status = directory.Prepare(); !status.ok()) return status;
  const auto authority = pki::Authority::Create(request.name, request.days);
  if (!authority.ok()) return authority.status();
  return Report(
      directory, pki::kAuthorityName,
      directory.Write(pki::kAuthorityName, (*authority)->credentials(), request.existing()));
}

/// A certificate's files must not replace the authority's.
absl::Status CheckFileName(const std::string& name) {
  if (name.empty() || name == pki::kAuthorityName || name.front() == '.' ||
      name.find('/') != std::string::npos) {
    return absl::InvalidArgumentError(fmt::format(
        "--name \"{}\": it must be a file name without /, and neither hidden nor \"{}\"", name,
        pki::kAuthorityName));
  }
  return absl::OkStatus();
}

absl::Status IssueOne(const pki::Authority& authority, const Request& request,
                      const std::string& name, const absl::StatusOr<pki::Profile>& profile) {
  if (!profile.ok()) return profile.status();
  const pki::Directory directory(request.directory);
  const absl::StatusOr<pki::Credentials> made = authority.Issue(*profile, request.days);
  if (!made.ok()) return made.status();
  return Report(directory, name, directory.Write(name, *made, request.existing()));
}

absl::Status Issue(const Request& request, const absl::StatusOr<pki::Profile>& profile) {
  if (absl::Status status = CheckFileName(request.name); !status.ok()) return status;
  const auto authority = pki::Directory(request.directory).LoadAuthority();
  if (!authority.ok()) return authority.status();
  return IssueOne(**authority, request, request.name, profile);
}

absl::Status IssueRobots(const Request& request) {
  if (request.count == 0) {
    if (request.ruris.empty()) return absl::InvalidArgumentError("--ruri is required");
    return Issue(request, pki::RobotProfile(request.ruris.front(), request.fleet, request.name));
  }
  const auto authority = pki::Directory(request.directory).LoadAuthority();
  if (!authority.ok()) return authority.status();
  const std::string prefix = request.ruris.empty() ? kRuriPrefixDefault : request.ruris.front();
  for (int i = 1; i <= request.count; ++i) {
    const std::string name = fmt::format("robot-{:04}", i);
    absl::Status status =
        IssueOne(**authority, request, name,
                 pki::RobotProfile(fmt::format("{}/{}", prefix, name), request.fleet, name));
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

CLI::App* AddVerb(CLI::App& noun, const SharedRequest& request, const std::string& verb,
                  const std::string& description) {
  CLI::App* const app = noun.add_subcommand(verb, description);
  app->add_option("--dir", request->directory, "Folder of the files")->capture_default_str();
  app->add_option("--days", request->days, "Days that the certificate is valid")
      ->capture_default_str()
      ->check(CLI::Range(1, pki::kDaysMax));
  app->add_flag("--force", request->force, "Replace files that are already there");
  return app;
}

void AddFleet(CLI::App* app, const SharedRequest& request, const std::string& meaning) {
  app->add_option("--fleet", request->fleet, meaning)->capture_default_str();
}

void AddName(CLI::App* app, const SharedRequest& request, const std::string& name) {
  request->name = name;
  app->add_option("--name", request->name, "Name of the files, and for people in the certificate")
      ->capture_default_str();
}

void AddInit(CLI::App& noun, Action& action) {
  const auto request = std::make_shared<Request>();
  request->days = pki::kAuthorityDaysDefault;
  request->name = "uplinkd development authority";
  CLI::App* const app = AddVerb(noun, request, "init", "Make an authority: ca.crt and ca.key");
  app->add_option("--common-name", request->name, "The authority's name, for people")
      ->capture_default_str();
  app->callback([request, &action] { action = [request] { return ExitOf(Init(*request)); }; });
}

void AddServer(CLI::App& noun, Action& action) {
  const auto request = std::make_shared<Request>();
  CLI::App* const app = AddVerb(noun, request, "server", "Make the server's certificate");
  AddName(app, request, "server");
  app->add_option("--host", request->hosts, "DNS name or IP address that robots dial (repeatable)")
      ->required()
      ->take_all();
  app->callback([request, &action] {
    action = [request] { return ExitOf(Issue(*request, pki::ServerProfile(request->hosts))); };
  });
}

void AddRobot(CLI::App& noun, Action& action) {
  const auto request = std::make_shared<Request>();
  CLI::App* const app =
      AddVerb(noun, request, "robot", "Make the certificate of one or more robots");
  AddName(app, request, "robot");
  AddFleet(app, request, "Fleet that owns the robot");
  app->add_option("--ruri", request->ruris,
                  "The robot's RURI, rcan://...; with --count what comes before /robot-0001")
      ->expected(1);
  app->add_option("--count", request->count, "Make that many: robot-0001, robot-0002, ...")
      ->check(CLI::Range(1, kCountMax))
      ->excludes("--name");
  app->callback(
      [request, &action] { action = [request] { return ExitOf(IssueRobots(*request)); }; });
}

void AddGateway(CLI::App& noun, Action& action) {
  const auto request = std::make_shared<Request>();
  CLI::App* const app = AddVerb(noun, request, "gateway", "Make a gateway's certificate");
  AddName(app, request, "gateway");
  AddFleet(app, request, "Fleet of the gateway's robots");
  app->add_option("--ruri", request->ruris,
                  "Robot that it may speak for (repeatable); none: all of the fleet")
      ->take_all();
  app->callback([request, &action] {
    action = [request] {
      return ExitOf(
          Issue(*request, pki::GatewayProfile(request->ruris, request->fleet, request->name)));
    };
  });
}

void AddOperator(CLI::App& noun, Action& action) {
  const auto request = std::make_shared<Request>();
  CLI::App* const app = AddVerb(noun, request, "operator", "Make an operator's certificate");
  AddName(app, request, "operator");
  AddFleet(app, request, "Fleet that the operator may see; *: all");
  app->add_option("--role", request->role, "viewer, operator or admin")->capture_default_str();
  app->callback([request, &action] {
    action = [request] {
      return ExitOf(
          Issue(*request, pki::OperatorProfile(request->role, request->fleet, request->name)));
    };
  });
}

}  // namespace

void AddPki(CLI::App& app, Action& action) {
  CLI::App* const noun =
      app.add_subcommand("pki", "Certificates for development and small fleets (ECDSA P-256)");
  noun->require_subcommand(1);
  AddInit(*noun, action);
  AddServer(*noun, action);
  AddRobot(*noun, action);
  AddOperator(*noun, action);
  AddGateway(*noun, action);
}

}  // namespace uplink::ctl
