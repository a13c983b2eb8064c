#include "tools/uplinkctl/pki_list.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "schema/base/clock.h"
#include "schema/base/rfc3339.h"
#include "tools/pki/listed.h"
#include "tools/uplinkctl/command.h"
#include "tools/uplinkctl/verbs/common.h"

namespace uplink::ctl {
namespace {

namespace json = boost::json;

struct Request {
  std::string directory = "./pki";
  std::string name;
  CommonFlags common;
};

Columns CertificateColumns() {
  return {{"NAME", "name"},
          {"KIND", "kind"},
          {"FLEET", "fleet"},
          {"EXPIRES", "expires", Kind::kAge},
          {"KEY", "hasKey", Kind::kYes},
          {"FOR", "names", Kind::kList, Fit::kShrink},
          {"WRONG", "why", Kind::kText, Fit::kDrop}};
}

json::object ObjectOf(const pki::Listed& listed) {
  json::array names;
  for (const std::string& name : listed.names) names.emplace_back(name);
  return {{"name", listed.name},
          {"kind", listed.kind},
          {"why", listed.why},
          {"fleet", listed.fleet},
          {"names", std::move(names)},
          {"begins", Rfc3339(listed.begins)},
          {"expires", Rfc3339(listed.expires)},
          {"hasKey", listed.has_key},
          {"subject", listed.subject},
          {"issuer", listed.issuer},
          {"serial", listed.serial},
          {"sha256", listed.sha256},
          {"keySha256", listed.key_sha256}};
}

absl::Status List(const Request& request) {
  const pki::Directory directory(request.directory);
  const absl::StatusOr<std::vector<std::string>> names = pki::NamesIn(directory);
  if (!names.ok()) return names.status();
  json::array rows;
  for (const std::string& name : *names) {
    const absl::StatusOr<pki::Listed> listed = pki::ReadListed(directory, name);
    if (listed.ok()) {
      rows.push_back(ObjectOf(*listed));
    } else {
      rows.push_back(json::object{
          {"name", name}, {"kind", "unknown"}, {"why", std::string(listed.status().message())}});
    }
  }
  const SystemClock clock;
  const Screen screen = ProcessScreen(clock);
  switch (request.common.format()) {
    case Format::kJson:
      screen.print(DocumentText(json::object{{"certificates", std::move(rows)}}, false));
      break;
    case Format::kCsv:
      screen.print(CsvOf(CertificateColumns(), rows, true));
      break;
    case Format::kTable:
      if (rows.empty()) screen.note("there is no certificate in " + request.directory);
      screen.print(TableOf(CertificateColumns(), rows, screen.Terms()));
      break;
  }
  return absl::OkStatus();
}

absl::Status Show(const Request& request) {
  const absl::StatusOr<pki::Listed> listed =
      pki::ReadListed(pki::Directory(request.directory), request.name);
  if (!listed.ok()) return listed.status();
  const SystemClock clock;
  const Screen screen = ProcessScreen(clock);
  screen.print(ObjectText(ObjectOf(*listed), request.common.format(), screen));
  return absl::OkStatus();
}

config::Flags& AddVerb(config::Flags& noun, const std::shared_ptr<Request>& request,
                       const char* name, const char* about, absl::Status (*work)(const Request&)) {
  config::Flags& verb =
      noun.AddCommand(name, about, [request, work] { return ExitOf(work(*request)); });
  verb.Add({"--dir", "Folder of the files"}, request->directory);
  AddOutputFlags(verb, request->common, false);
  return verb;
}

}  // namespace

void AddPkiList(config::Flags& noun) {
  const auto request = std::make_shared<Request>();
  AddVerb(noun, request, "list", "List the certificates of a folder, and when each expires", List)
      .Example("uplinkctl pki list --dir pki");
  config::Flags& show = AddVerb(noun, request, "show", "Show one certificate of a folder", Show);
  show.Add({"NAME", "Name of its files, without .crt", config::Flag::Need::kRequired},
           request->name);
  show.Example("uplinkctl pki show --dir pki r1");
}

}  // namespace uplink::ctl
