#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <absl/status/statusor.h>
#include <fmt/core.h>

#include "schema/base/clock.h"
#include "tools/pki/authority.h"
#include "tools/pki/directory.h"
#include "tools/pki/kept.h"
#include "tools/pki/profile.h"
#include "tools/uplinkctl/command.h"
#include "tools/uplinkctl/pki_list.h"

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
  bool keep = false;
  std::vector<std::string> hosts;
  std::string ruri;
  std::vector<std::string> ruris;
  std::string role = "viewer";
  std::string copy_to;
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

/// Whether the call keeps a pair that is there; then it says so.
///
/// Errors: the pair is not whole, or not fit to be kept.
absl::StatusOr<bool> Keeps(const Request& request, const std::string& name,
                           const pki::Wanted& wanted) {
  if (!request.keep) return false;
  const pki::Directory directory(request.directory);
  absl::StatusOr<bool> there = directory.HasPair(name);
  if (!there.ok() || !*there) return there;
  absl::Status fit = pki::CheckKept(directory, name, wanted, SystemClock().System());
  if (!fit.ok()) return fit;
  fmt::print("kept {}\n", directory.CertificatePath(name));
  return true;
}

absl::Status Init(const Request& request) {
  const pki::Directory directory(request.directory);
  if (absl::Status status = directory.Prepare(); !status.ok()) return status;
  const absl::StatusOr<bool> kept = Keeps(request, pki::kAuthorityName, {});
  if (!kept.ok() || *kept) return kept.status();
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
  const absl::StatusOr<bool> kept =
      Keeps(request, name,
            {.authority_pem = authority.credentials().certificate_pem,
             .hosts = request.hosts,
             .client = profile->server ? std::nullopt : std::optional<pki::Profile>(*profile)});
  if (!kept.ok() || *kept) return kept.status();
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

/// Where a server runs, the authority's key should not be.
absl::Status IssueServer(const Request& request) {
  absl::Status status = Issue(request, pki::ServerProfile(request.hosts));
  if (!status.ok() || request.copy_to.empty()) return status;
  const pki::Directory from(request.directory);
  const pki::Directory into(request.copy_to);
  if (status = into.Prepare(); !status.ok()) return status;
  const auto authority = from.Read(pki::kAuthorityName);
  if (!authority.ok()) return authority.status();
  const auto server = from.Read(request.name);
  if (!server.ok()) return server.status();
  status = into.WriteCertificate(pki::kAuthorityName, *authority);
  return status.ok() ? into.Write(request.name, *server, pki::Existing::kReplace) : status;
}

absl::Status IssueRobots(const Request& request) {
  if (request.count == 0) {
    if (request.ruri.empty())
      return absl::InvalidArgumentError(
          "--ruri is required: the robot's rcan://..., or --count N for N robots");
    return Issue(request, pki::RobotProfile(request.ruri, request.fleet, request.name));
  }
  const auto authority = pki::Directory(request.directory).LoadAuthority();
  if (!authority.ok()) return authority.status();
  const std::string prefix = request.ruri.empty() ? kRuriPrefixDefault : request.ruri;
  for (int i = 1; i <= request.count; ++i) {
    const std::string name = fmt::format("robot-{:04}", i);
    absl::Status status =
        IssueOne(**authority, request, name,
                 pki::RobotProfile(fmt::format("{}/{}", prefix, name), request.fleet, name));
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

struct Verb {
  std::string name;
  std::string about;
  absl::Status (*work)(const Request&);
};

config::Flags& AddVerb(config::Flags& noun, const SharedRequest& request, const Verb& verb) {
  config::Flags& flags = noun.AddCommand(
      verb.name, verb.about, [request, work = verb.work] { return ExitOf(work(*request)); });
  flags.Add({"--dir", "Folder of the files"}, request->directory);
  flags.Add({"--days", "Days that the certificate is valid"}, request->days, {1, pki::kDaysMax});
  flags.AddSwitch({"--force", "Replace files that are already there"}, request->force);
  flags.AddSwitch(
      {"--keep", "Leave files that are already there: check them, and make those that are missing"},
      request->keep);
  flags.AtMostOne({"--force", "--keep"});
  return flags;
}

void AddName(config::Flags& flags, Request& request, const std::string& name) {
  request.name = name;
  flags.Add({"--name", "Name of the files, and for people in the certificate"}, request.name);
}

void AddInit(config::Flags& noun) {
  const auto request = std::make_shared<Request>();
  request->days = pki::kAuthorityDaysDefault;
  config::Flags& flags =
      AddVerb(noun, request, {"init", "Make an authority: ca.crt and ca.key", Init});
  flags.Add({"--common-name", "The authority's name (default: one that no other has)"},
            request->name);
  flags.Example("uplinkctl pki init --dir pki");
}

void AddServer(config::Flags& noun) {
  const auto request = std::make_shared<Request>();
  config::Flags& flags =
      AddVerb(noun, request, {"server", "Make the server's certificate", IssueServer});
  AddName(flags, *request, "server");
  flags.Add({"--host", "DNS name or IP address that robots dial (repeatable)",
             config::Flag::Need::kRequired},
            request->hosts);
  flags.Add({"--copy-to",
             "Folder that gets copies of what the server needs, in place of older ones: NAME.crt, "
             "NAME.key and ca.crt"},
            request->copy_to);
  flags.Example("uplinkctl pki server --dir pki --host uplink.example.org --host 192.0.2.7");
}

void AddRobot(config::Flags& noun) {
  const auto request = std::make_shared<Request>();
  config::Flags& flags =
      AddVerb(noun, request, {"robot", "Make the certificate of one or more robots", IssueRobots});
  AddName(flags, *request, "robot");
  flags.Add({"--fleet", "Fleet that owns the robot"}, request->fleet);
  flags.Add({"--ruri", "The robot's RURI, rcan://...; with --count what comes before /robot-0001"},
            request->ruri);
  flags.Add({"--count", "Make that many: robot-0001, robot-0002, ..."}, request->count,
            {1, kCountMax});
  flags.AtMostOne({"--count", "--name"});
  flags.Example("uplinkctl pki robot --dir pki --ruri rcan://example.org/a/b/1.0/r1 --name r1");
  flags.Example("uplinkctl pki robot --dir pki --count 20");
}

void AddGateway(config::Flags& noun) {
  const auto request = std::make_shared<Request>();
  const auto work = [](const Request& asked) {
    return Issue(asked, pki::GatewayProfile(asked.ruris, asked.fleet, asked.name));
  };
  config::Flags& flags = AddVerb(noun, request, {"gateway", "Make a gateway's certificate", work});
  AddName(flags, *request, "gateway");
  flags.Add({"--fleet", "Fleet of the gateway's robots"}, request->fleet);
  flags.Add({"--ruri", "Robot that it may speak for (repeatable); none: all of the fleet"},
            request->ruris);
  flags.Example("uplinkctl pki gateway --dir pki --fleet north --name gateway-1");
}

void AddOperator(config::Flags& noun) {
  const auto request = std::make_shared<Request>();
  const auto work = [](const Request& asked) {
    return Issue(asked, pki::OperatorProfile(asked.role, asked.fleet, asked.name));
  };
  config::Flags& flags =
      AddVerb(noun, request, {"operator", "Make an operator's certificate", work});
  AddName(flags, *request, "operator");
  flags.Add({"--fleet", "Fleet that the operator may see; *: all"}, request->fleet);
  flags.AddChoice({"--role", "What the operator may do"}, request->role,
                  {"viewer", "operator", "admin", "metrics"});
  flags.Example("uplinkctl pki operator --dir pki --role viewer --fleet north");
}

}  // namespace

void AddPki(config::Flags& program) {
  config::Flags& noun =
      program.AddCommand("pki", "Certificates for development and small fleets (ECDSA P-256)");
  AddInit(noun);
  AddServer(noun);
  AddRobot(noun);
  AddOperator(noun);
  AddGateway(noun);
  AddPkiList(noun);
}

}  // namespace uplink::ctl
