#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <unistd.h>

#include "metrics/catalogue.h"
#include "metrics/rcan/series.h"
#include "schema/base/clock.h"
#include "server/config/flags.h"
#include "server/config/load.h"
#include "server/config/version.h"
#include "server/health/process.h"
#include "server/log/journal_stream.h"
#include "server/log/logger.h"
#include "server/log/standard_error.h"
#include "server/run/app.h"
#include "server/run/deadline.h"
#include "server/run/drain.h"
#include "server/run/from_config.h"
#include "server/run/greeting.h"
#include "server/run/process_setup.h"
#include "server/store/clock_judge.h"
#include "server/store/marked_clock.h"

namespace uplink {
namespace {

constexpr int kExitDone = 0;
constexpr int kExitFailed = 1;
constexpr int kExitWrongUse = 2;

struct Arguments {
  std::string config_file = config::kConfigFileDefault;
  bool check_config = false;
  bool print_config = false;
  bool print_metrics = false;
};

bool IntoJournal() { return log::IsJournal(config::JournalStream(), STDERR_FILENO); }

/// Beside the log, before there is one. Each line has its priority where the log's lines have.
void Complain(log::Level level, std::string_view text) {
  const std::string_view priority = IntoJournal() ? log::PriorityOf(level) : "";
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    fmt::print(stderr, "{}{}\n", priority, line);
    text.remove_prefix(std::min(text.size(), line.size() + 1));
  }
}

void PrintProblems(const std::vector<config::Problem>& problems) {
  for (const config::Problem& problem : problems) {
    Complain(log::Level::kError, "uplinkd: " + config::ToText(problem));
  }
}

/// The configuration with every problem of the text and of the files that it names.
config::LoadResult Load(const std::string& path) {
  return config::WithFiles(config::LoadConfig(path, config::ProcessEnvironment()));
}

int CheckConfig(const Arguments& arguments) {
  config::LoadResult result = Load(arguments.config_file);
  if (result.readable) {
    for (config::Note& note : config::ExpiredFiles(*result.readable, SystemClock().System())) {
      result.notes.push_back(std::move(note));
    }
  }
  for (const config::Note& note : result.notes) {
    Complain(log::Level::kWarn, "uplinkd: note: " + config::ToText(note));
  }
  PrintProblems(result.problems);
  if (!result.problems.empty()) return kExitWrongUse;
  fmt::print("{}: good\n", arguments.config_file);
  return kExitDone;
}

int PrintConfig(const Arguments& arguments) {
  const config::LoadResult result =
      config::LoadConfig(arguments.config_file, config::ProcessEnvironment());
  PrintProblems(result.problems);
  if (!result.ok()) return kExitWrongUse;
  fmt::print("{}", config::PrintConfig(*result.config));
  return kExitDone;
}

storage::ProcessId DrawProcessId() {
  std::random_device device;
  std::uniform_int_distribution<unsigned> byte(0, 255);
  storage::ProcessId id{};
  for (std::uint8_t& part : id) part = static_cast<std::uint8_t>(byte(device));
  return id;
}

std::unique_ptr<log::Logger> MakeLogger(const config::LogConfig& config, const Clock& clock) {
  const log::Format format = run::LogFormatOf(config.format);
  auto lines =
      log::StandardError(clock, {.format = format, .priorities = IntoJournal(), .limits = {}});
  return std::make_unique<log::Logger>(std::move(lines), clock, format,
                                       run::LogLevelOf(config.level));
}

/// Serves until it is told to stop; the exit code.
int ServeBy(const Arguments& arguments, const config::LoadResult& loaded,
            const Clock& machine_clock, log::Logger& logger, run::Greeting& greeting) {
  store::MarkedClock clock(machine_clock);
  const SystemBootClock boot_clock;
  for (const config::Note& note : loaded.notes) {
    logger.Warn(note.event, {{"note", config::ToText(note)}});
  }
  std::mt19937_64 random(std::random_device{}());
  auto app = run::App::Start({.config = *loaded.config,
                              .config_file = arguments.config_file,
                              .places = loaded.places,
                              .read_config = [path = arguments.config_file] { return Load(path); },
                              .logger = logger,
                              .clock = clock,
                              .boot_clock = boot_clock,
                              .kernel_clock_synchronised = store::KernelClockSynchronised,
                              .process = DrawProcessId(),
                              .random = [&random] { return random(); },
                              .version = std::string(config::Version()),
                              .greeting = greeting});
  if (!app.ok()) {
    greeting.TellFailed(app.status());
    return kExitFailed;
  }
  return (*app)->Run();
}

int Serve(const Arguments& arguments) {
  const config::LoadResult loaded = Load(arguments.config_file);
  PrintProblems(loaded.problems);
  if (!loaded.ok()) return kExitWrongUse;
  const std::size_t descriptors = run::SetUpProcess();
  const SystemClock machine_clock;
  auto logger = MakeLogger(loaded.config->log, machine_clock);
  run::Greeting greeting({.logger = *logger,
                          .config = *loaded.config,
                          .config_file = arguments.config_file,
                          .clock = machine_clock,
                          .descriptor = STDERR_FILENO});
  greeting.Begin();
  logger->Info("starting", {{"version", config::Version()},
                            {"descriptors_max", descriptors},
                            {"memory_bytes_max", health::MemoryMax()}});
  const int code = ServeBy(arguments, loaded, machine_clock, *logger, greeting);
  // The log's end waits for its reader for kFlushWait; in a write that blocks (WriteAll) for ever.
  const run::Deadline last(run::kLogEndWait, [code] { std::_Exit(code); });
  logger.reset();
  return code;
}

int Main(int argc, char** argv) {
  config::Flags flags("Telemetry ingestion for robot fleets", "uplinkd", config::VersionText());
  Arguments arguments;
  flags.Add({"--config", "The configuration file"}, arguments.config_file);
  flags.AddSwitch({"--check-config", "Report every problem of the configuration; exit 0 or 2"},
                  arguments.check_config);
  flags.AddSwitch({"--print-config", "Print the effective configuration, secrets masked"},
                  arguments.print_config);
  flags.AddSwitch({"--print-metrics", "Print the metrics as a table"}, arguments.print_metrics);
  flags.AtMostOne({"--check-config", "--print-config", "--print-metrics"});
  flags.Example("uplinkd --config /etc/uplinkd/uplinkd.toml");
  flags.Example("uplinkd --config /etc/uplinkd/uplinkd.toml --check-config");
  const auto complain = [](std::string_view text) { Complain(log::Level::kError, text); };
  if (const auto code = flags.Parse(argc, argv, complain)) return *code;
  if (arguments.print_metrics) {
    fmt::print("{}\n{}", metrics::CatalogueTable(),
               metrics::rcan::SeriesTable(config::RcanConfig().subsystem));
    return kExitDone;
  }
  if (arguments.check_config) return CheckConfig(arguments);
  if (arguments.print_config) return PrintConfig(arguments);
  return Serve(arguments);
}

}  // namespace
}  // namespace uplink

int main(int argc, char** argv) { return uplink::Main(argc, argv); }
