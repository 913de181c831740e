#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <apps/cli/commands.hpp>
#include <stribeck/ident/refused.hpp>
#include <stribeck/io/error.hpp>
#include <stribeck/io/file.hpp>
#include <stribeck/io/printable.hpp>
#include <stribeck/report/shell_words.hpp>
#include <stribeck/sim/contour_run.hpp>

namespace stribeck::cli {
namespace {

constexpr int kNo = 1;
constexpr int kBadInput = 2;

std::string command_line;

/// One line on stderr, whatever a message holds and however long it is.
void complain(std::string_view message) {
  constexpr std::size_t kLongest = 1900;
  // fmt::print throws where nobody reads; the exit code counts then.
  const std::string line = fmt::format("stribeck: {}\n", io::shortened(io::printable(message), kLongest));
  std::fwrite(line.data(), 1, line.size(), stderr);
}

/// Message for an argument that the verb does not have: a similar option, or that it is one too many.
std::string unknown(const CLI::App& verb) {
  const std::vector<std::string> rest = verb.remaining();
  const auto option =
      std::find_if(rest.begin(), rest.end(), [](const auto& r) { return r.starts_with('-'); });
  if (option == rest.end())
    return fmt::format("got {}, expected no further argument",
                       io::in_quotes(rest.empty() ? std::string() : rest.front()));
  std::vector<std::string> names;
  for (const CLI::Option* o : verb.get_options()) {
    for (const std::string& name : o->get_lnames()) names.push_back("--" + name);
  }
  const std::string name = option->substr(0, option->find('='));
  const std::string_view near = io::nearest(name, {names.begin(), names.end()});
  return fmt::format("unknown option {}{}", io::in_quotes(name),
                     near.empty() ? std::string() : fmt::format(", did you mean {}", near));
}

/// Rewrites messages of the CLI library about types and counts in the style of this program.
std::string in_words(const CLI::ParseError& e, const CLI::App* verb) {
  const std::string text = e.what();
  const std::string option = text.substr(0, text.find(": "));
  const auto holds = [&](std::string_view with) { return text.find(with) != std::string::npos; };
  if (e.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError) && verb != nullptr)
    return unknown(*verb);
  if (e.get_exit_code() == static_cast<int>(CLI::ExitCodes::ArgumentMismatch)) {
    if (holds(" missing")) return option + ": got nothing, expected a value";
    if (holds(": At Most 1 required")) return option + ": given more than once, expected one value";
  }
  return text;
}

int parse_and_run(int argc, const char* const* argv) {
  CLI::App app{
      "Identifies the friction of machine-tool feed drives from logs, shows its effect on the contour, and compensates it."};
  app.name("stribeck");
  app.set_version_flag("--version", "stribeck " STRIBECK_VERSION);
  app.require_subcommand(1);
  app.failure_message([](const CLI::App*, const CLI::Error& e) { return std::string(e.what()); });
  Action action;
  for (const auto add_verb : kVerbs) add_verb(app, action);
  add_reference(app, action);
  add_board_host(app, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    return app.exit(e);  // --help and --version print to stdout
  } catch (const CLI::ParseError& e) {
    if (argc > 1 && argv[1][0] != '-' && app.get_subcommands().empty()) {
      std::vector<std::string> verbs;
      for (const CLI::App* verb : app.get_subcommands(nullptr)) {
        if (!verb->get_group().empty()) verbs.push_back(verb->get_name());
      }
      const std::string_view near = io::nearest(argv[1], {verbs.begin(), verbs.end()});
      complain(fmt::format("unknown verb {}{} (stribeck --help lists the verbs)", io::in_quotes(argv[1]),
                           near.empty() ? "" : fmt::format(", did you mean {}", near)));
      return kBadInput;
    }
    const auto verbs = app.get_subcommands();
    const CLI::App* const verb = verbs.empty() ? nullptr : verbs.front();
    complain(fmt::format(
        "{} (stribeck {})", in_words(e, verb),
        verb == nullptr ? "--help lists the verbs" : verb->get_name() + " --help lists the options"));
    return kBadInput;
  }
  io::WriteTogether outputs;
  int code = kNo;
  try {
    code = action();
  } catch (const ident::Refused&) {
    outputs.commit();  // what was written explains the answer "no"
    throw;
  } catch (const sim::Refused&) {
    outputs.commit();
    throw;
  }
  outputs.commit();
  // Last: files do not wait for a reader.
  const bool flushed = std::fflush(stdout) == 0;
  const int error = errno;
  if (flushed && std::ferror(stdout) == 0) return code;
  complain(fmt::format("cannot write to standard output{}",
                       flushed ? "" : ": " + std::generic_category().message(error)));
  return kBadInput;
}

}  // namespace

const std::string& typed_command() { return command_line; }

int run(int argc, const char* const* argv) {
  // A reader that is gone is an error of the write, which is said.
  std::signal(SIGPIPE, SIG_IGN);
  command_line = "stribeck";
  for (int i = 1; i < argc; ++i) command_line += ' ' + report::shell_quoted(argv[i]);
  try {
    return parse_and_run(argc, argv);
  } catch (const io::InputError& e) {
    constexpr std::size_t kMost = 100;
    const std::size_t all = e.problems().size();
    for (std::size_t i = 0; i < std::min(all, kMost); ++i) complain(e.problems()[i].text());
    if (all > kMost) complain(fmt::format("and {} more", all - kMost));
    return kBadInput;
  } catch (const ident::Refused& e) {
    complain(e.what());
    return kNo;
  } catch (const sim::Refused& e) {
    complain(e.what());
    return kNo;
  } catch (const std::bad_alloc&) {
    complain("out of memory; shorten the log or the experiment");
    return kBadInput;
  } catch (const std::exception& e) {
    complain(e.what());
    return kBadInput;
  }
}

}  // namespace stribeck::cli
