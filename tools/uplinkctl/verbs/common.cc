#include "tools/uplinkctl/verbs/common.h"

#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

#include <fmt/core.h>
#include <unistd.h>

#include "tools/link/http_client.h"
#include "tools/terminal/terminal.h"
#include "tools/uplinkctl/ask/store_desk.h"
#include "tools/uplinkctl/command.h"
#include "tools/uplinkctl/show/json_text.h"
#include "tools/uplinkctl/show/one_line.h"

namespace uplink::ctl {
namespace {

/// How often --follow looks.
constexpr std::chrono::seconds kFollowEvery{2};
/// To the first cell, and what was there goes.
constexpr std::string_view kClear = "\x1b[H\x1b[2J";

bool Print(std::string_view text, std::FILE* to) {
  return std::fwrite(text.data(), 1, text.size(), to) == text.size() && std::fflush(to) == 0;
}

/// Answers from the store of --config what a server that cannot be reached does not.
class Fallback final {
 public:
  Fallback(std::string config, std::string prefix, const Screen& screen)
      : config_(std::move(config)), prefix_(std::move(prefix)), screen_(screen) {}

  absl::StatusOr<link::HttpAnswer> Or(absl::StatusOr<link::HttpAnswer> answer,
                                      const std::string& target, const std::string* json) {
    if (config_.empty() || !absl::IsUnavailable(answer.status())) return answer;
    const absl::StatusOr<std::unique_ptr<StoreDesk>> desk = StoreDesk::Open(config_);
    if (!desk.ok()) {
      return absl::UnavailableError(fmt::format("{}; and its store: {}",
                                                std::string(answer.status().message()),
                                                std::string(desk.status().message())));
    }
    std::optional<link::HttpAnswer> of_store = (*desk)->Answer(target.substr(prefix_.size()), json);
    if (!of_store) return answer;
    screen_.note("no server answers, so the store does");
    return *std::move(of_store);
  }

 private:
  const std::string config_;
  const std::string prefix_;
  const Screen& screen_;
};

}  // namespace

void AddAccessFlags(config::Flags& verb, AccessFiles& files) {
  verb.Add({"--token-file", fmt::format("A file whose first line is your token (without a flag {})",
                                        kTokenVariable)},
           files.token_file);
  verb.Add({"--ca-file", "Authorities of an https server (without it the system's)"},
           files.ca_file);
  verb.Add({"--certificate-file", "Your certificate, for https"}, files.certificate_file);
  verb.Add({"--key-file", "Its private key"}, files.key_file);
}

void AddServerFlags(config::Flags& verb, ServerFlags& flags, const char* about_config) {
  verb.Add({"--server", fmt::format("Which server: {} (without a flag {}, the current context, {})",
                                    kUrlForms, kServerVariable, kServerDefault)},
           flags.server);
  verb.Add({"--context", "Which server: by its name of uplinkctl contexts"}, flags.context);
  verb.Add({"--config", about_config}, flags.config);
  verb.AtMostOne({"--server", "--context", "--config"});
  AddAccessFlags(verb, flags.files);
}

void AddOutputFlags(config::Flags& verb, CommonFlags& flags, bool follows) {
  verb.AddChoice({"-o,--output",
                  "How it is printed: json as the server answers it, csv with whole "
                  "names and times"},
                 flags.output, {kTableWord, kJsonWord, kCsvWord});
  if (follows) verb.AddSwitch({"--follow", "Look again every 2 s, until Ctrl-C"}, flags.follow);
}

Screen ProcessScreen(const Clock& clock) {
  const Terminal terminal = TerminalOf(STDOUT_FILENO, environ);
  Screen screen{
      .print = [](std::string_view text) { static_cast<void>(Print(text, stdout)); },
      .note =
          [](std::string_view line) {
            static_cast<void>(Print(fmt::format("uplinkctl: {}\n", OneLine(line)), stderr));
          },
      .wait =
          [] {
            std::this_thread::sleep_for(kFollowEvery);
            // The reader of a pipe may have gone.
            return std::ferror(stdout) == 0;
          },
      .clock = clock,
      .updates = terminal.updates,
      .table = {}};
  // Other programs get whole lines.
  if (isatty(STDOUT_FILENO) == 1) screen.table.columns = SizeOf(STDOUT_FILENO).columns;
  screen.table.palette = Palette(terminal);
  return screen;
}

int WithServer(const ServerFlags& flags, const Work& work) {
  const absl::StatusOr<ServerChoice> choice = ChooseServer(flags, ProcessSources());
  if (!choice.ok()) return ExitOf(choice.status());
  const absl::StatusOr<link::HttpServer> server =
      ServerWith(choice->url, choice->files, choice->certificate_file);
  if (!server.ok()) return ExitOf(server.status());
  link::HttpClient client(*server);
  const SystemClock clock;
  const Screen screen = ProcessScreen(clock);
  Fallback fallback(flags.config, choice->url.prefix, screen);
  Api api(
      [&](const std::string& target) { return fallback.Or(client.Ask(target), target, nullptr); },
      choice->url.prefix, choice->source,
      [&](const std::string& target, const std::string& json) {
        return fallback.Or(client.Send(target, json), target, &json);
      },
      [](std::chrono::seconds time) { std::this_thread::sleep_for(time); });
  if (ShowsToken(*server)) {
    screen.note(fmt::format("the network can read the token on its way to {}; is there https?",
                            ToText(choice->url)));
  }
  return ExitOf(work(api, screen));
}

absl::Status ShowAgain(const Screen& screen, bool follow,
                       const std::function<absl::StatusOr<std::string>()>& text) {
  absl::StatusOr<std::string> shown = text();
  if (!shown.ok()) return shown.status();
  if (!follow) {
    screen.print(*shown);
    return absl::OkStatus();
  }
  screen.print((screen.updates ? std::string(kClear) : "") + *shown);
  while (screen.wait()) {
    shown = text();
    if (!shown.ok()) {
      screen.note(std::string(shown.status().message()));
      continue;
    }
    screen.print((screen.updates ? std::string(kClear) : "\n") + *shown);
  }
  return absl::OkStatus();
}

std::string ObjectText(const boost::json::object& object, Format format, const Screen& screen) {
  switch (format) {
    case Format::kJson:
      return DocumentText(object, false);
    case Format::kCsv:
      return FieldsCsvOf(object);
    case Format::kTable:
      return FieldsOf(object, screen.Terms());
  }
  return {};
}

std::string DocumentText(const boost::json::value& value, bool follow) {
  return (follow ? LineJson(value) : PrettyJson(value)) + '\n';
}

config::FlagForm NotEmpty() {
  return {.name = "TEXT", .problem = [](const std::string& text) {
            return text.empty() ? std::string("it is empty, which would show everything") : "";
          }};
}

}  // namespace uplink::ctl
