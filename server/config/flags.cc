#include "server/config/flags.h"

#include <cstdio>
#include <span>
#include <sstream>

#include <CLI/CLI.hpp>

#include "server/config/flag_errors.h"
#include "server/config/help_tree.h"
#include "server/config/nearest.h"

namespace uplink::config {
namespace {

constexpr int kExitWrongUse = 2;

void Print(const std::string& text, std::FILE* file) { std::fputs(text.c_str(), file); }

/// Without the zeros that std::to_string has behind a fraction.
std::string NumberText(double number) {
  std::ostringstream text;
  text.precision(15);
  text << number;
  return text.str();
}

/// The library's own validators name neither the limits nor a near word.
template <typename Number>
CLI::Validator InRange(Number min, Number max) {
  const std::string range =
      NumberText(static_cast<double>(min)) + " to " + NumberText(static_cast<double>(max));
  return CLI::Validator(
      [min, max, range](const std::string& text) {
        Number number{};
        const bool good = CLI::detail::lexical_cast(text, number) && number >= min && number <= max;
        return good ? std::string() : text + " is not allowed; it must be a number from " + range;
      },
      CLI::Range(min, max).get_description());
}

CLI::Validator OneOf(const std::vector<std::string>& choices) {
  return CLI::Validator(
      [choices](const std::string& text) {
        if (std::find(choices.begin(), choices.end(), text) != choices.end()) return std::string();
        return text + " is not allowed" +
               DidYouMean(text, choices, "; it must be one of " + CLI::detail::join(choices, ", "));
      },
      CLI::IsMember(choices).get_description());
}

}  // namespace

struct Flags::Parser {
  template <typename Value>
  CLI::Option* Add(const Flag& flag, Value& value) {
    const bool required = flag.need == Flag::Need::kRequired;
    CLI::Option* const option = app->add_option(flag.name, value, flag.about)->required(required);
    const bool several = option->get_expected_max() > 1;
    return required || several ? option : option->capture_default_str();
  }

  [[nodiscard]] std::optional<int> RunChosen() const {
    for (const auto& command : commands) {
      if (command->parser_->app->parsed()) return command->parser_->RunChosen();
    }
    return run ? std::optional(run()) : std::nullopt;
  }

  CLI::App_p app;
  std::vector<std::unique_ptr<Flags>> commands = {};
  std::function<int()> run = {};
};

Flags::Flags(const std::string& about, const std::string& program, const std::string& version)
    : parser_(new Parser{std::make_shared<CLI::App>(about, program)}) {
  if (!version.empty()) parser_->app->set_version_flag("--version", program + " " + version);
}

Flags::~Flags() = default;

template <typename Value>
void Flags::Add(const Flag& flag, Value& value) {
  parser_->Add(flag, value);
}
template void Flags::Add(const Flag&, std::string&);
template void Flags::Add(const Flag&, std::vector<std::string>&);
template void Flags::Add(const Flag&, int&);
template void Flags::Add(const Flag&, std::uint16_t&);
template void Flags::Add(const Flag&, std::uint32_t&);
template void Flags::Add(const Flag&, std::uint64_t&);

template <typename Number>
void Flags::Add(const Flag& flag, Number& value, const FlagRange& range) {
  const auto min = static_cast<Number>(range.min);
  const auto max = static_cast<Number>(range.max);
  CLI::Option* const option = parser_->Add(flag, value)->check(InRange(min, max));
  if (value < min || value > max) option->default_str("");
}
template void Flags::Add(const Flag&, int&, const FlagRange&);
template void Flags::Add(const Flag&, double&, const FlagRange&);
template void Flags::Add(const Flag&, std::uint64_t&, const FlagRange&);

void Flags::Add(const Flag& flag, std::string& value, const FlagForm& form) {
  parser_->Add(flag, value)->check(CLI::Validator(form.problem, form.name));
}

void Flags::AddChoice(const Flag& flag, std::string& value,
                      const std::vector<std::string>& choices) {
  parser_->Add(flag, value)->check(OneOf(choices));
}

void Flags::AddChoices(const Flag& flag, std::vector<std::string>& values,
                       const std::vector<std::string>& choices) {
  parser_->Add(flag, values)->check(OneOf(choices));
}

void Flags::AddSwitch(const Flag& flag, bool& value) {
  parser_->app->add_flag(flag.name, value, flag.about);
}

void Flags::AtMostOne(const std::vector<std::string>& names) {
  for (const std::string& one : names) {
    for (const std::string& other : names) {
      if (one != other) parser_->app->get_option(one)->excludes(other);
    }
  }
}

void Flags::ExactlyOne(const std::string& group, const std::vector<std::string>& names) {
  CLI::Option_group* const options = parser_->app->add_option_group(group);
  for (const std::string& name : names) options->add_option(parser_->app->get_option(name));
  options->require_option(1);
}

Flags& Flags::AddCommand(const std::string& name, const std::string& about,
                         std::function<int()> run) {
  Flags& command = *parser_->commands.emplace_back(std::make_unique<Flags>(about, name));
  command.parser_->run = std::move(run);
  parser_->app->add_subcommand(command.parser_->app);
  parser_->app->require_subcommand(1);
  return command;
}

void Flags::Example(const std::string& line) {
  const std::string before = parser_->app->get_footer();
  parser_->app->footer((before.empty() ? "Examples:" : before) + "\n  " + line);
}

std::optional<int> Flags::Parse(int argc, const char* const* argv, const Complain& complain) {
  CLI::App& app = *parser_->app;
  const std::span<const char* const> arguments(argv, static_cast<std::size_t>(argc));
  if (app.get_name().empty()) app.name(arguments.front());
  if (arguments.size() == 2 && arguments[1] == kHelpTree) {
    Print(HelpTree(app) + "\n", stdout);
    return 0;
  }
  std::string wrong = UnknownName(app, arguments.subspan(1));
  try {
    if (wrong.empty()) app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream asked;
    if (app.exit(error, asked, asked) == 0) {
      Print(asked.str(), stdout);
      return 0;
    }
    wrong = WrongUseText(app, error);
  }
  if (wrong.empty()) return parser_->RunChosen();
  const std::string line = app.get_name() + ": " + wrong + "\n";
  complain ? complain(line) : Print(line, stderr);
  return kExitWrongUse;
}

bool Flags::Given(const std::string& name) const {
  return parser_->app->get_option(name)->count() > 0;
}

}  // namespace uplink::config
