#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <string_view>

#include <apps/cli/shell/shell_pages.hpp>
#include <stribeck/io/file.hpp>

namespace stribeck::cli {
namespace {

/// Text for troff: what it takes for a command, an escape or a hyphen stays what it is.
std::string troff(std::string_view text) {
  std::string out;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    line_begins = c == '\n';
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else if (c == '\'') {
      out += "\\(aq";
    } else if (c == '`') {
      out += "\\(ga";
    } else if (c == '^') {
      out += "\\(ha";
    } else if (c == '~') {
      out += "\\(ti";
    } else {
      out += c;
    }
  }
  return out;
}

std::string head(std::string_view name, std::string_view meaning, const DescribedCommand& command) {
  std::string title;
  for (const char c : name) title += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  // No date: the same program gives the same bytes.
  return fmt::format(".TH {} 1 \"\" \"{}\" \"Stribeck\"\n.nh\n.ad l\n.SH NAME\n{} \\- {}\n", troff(title),
                     command.version, troff(name), troff(meaning));
}

/// The value of an option; a long list of words may be broken behind a comma.
std::string troff_value(const std::string& value) {
  std::string out;
  for (const char c : troff(value)) out += c == ',' ? std::string(",\\:") : std::string(1, c);
  return out;
}

std::string entry(const DescribedOption& o) {
  std::string out = ".TP\n";
  for (std::size_t i = 0; i < o.names.size(); ++i)
    out += fmt::format("{}\\fB{}\\fR", i == 0 ? "" : ", ", troff(o.names[i]));
  if (!o.value.empty()) out += fmt::format(" \\fI{}\\fR", troff_value(o.value));
  out += '\n' + troff(o.meaning) + '.';
  if (o.required) out += " Required.";
  if (o.repeatable && o.meaning.find("repeat") == std::string::npos) out += " May be repeated.";
  if (!o.initial.empty()) out += fmt::format(" Default: {}.", troff(o.initial));
  return out + '\n';
}

constexpr std::string_view kExitStatus =
    ".SH EXIT STATUS\n.TP\n0\ndone\n.TP\n1\nthe answer is no\n.TP\n2\nwrong usage or bad input; one line on standard error says "
    "what and where\n";

/// Examples as in the footer of --help: its lines with two blanks are commands.
std::string examples_of(const DescribedVerb& verb) {
  const auto end = verb.examples.find('\n');
  if (end == std::string::npos) return {};
  return ".SH EXAMPLES\n.nf\n" + troff(verb.examples.substr(end + 1)) + "\n.fi\n";
}

std::string verb_page(const DescribedCommand& command, const DescribedVerb& verb) {
  const std::string name = "stribeck-" + verb.name;
  std::string synopsis;
  std::string arguments;
  std::string options;
  for (const DescribedOption& o : verb.options) {
    if (o.positional)
      synopsis += fmt::format(" \\fI{}\\fR{}", troff(o.names.front()), o.repeatable ? " .\\|.\\|." : "");
    (o.positional ? arguments : options) += entry(o);
  }
  std::string out = head(name, verb.meaning, command);
  out += fmt::format(".SH SYNOPSIS\n\\fBstribeck {}\\fR [\\fIOPTION\\fR] .\\|.\\|.{}\n", troff(verb.name),
                     synopsis);
  out += ".SH DESCRIPTION\n" + troff(verb.meaning) + ".\n";
  if (!arguments.empty()) out += ".SH ARGUMENTS\n" + arguments;
  out += ".SH OPTIONS\nA quantity is text with its unit, e.g. \"9.5 mm/s\".\n" + options;
  return out + examples_of(verb) + std::string(kExitStatus) + ".SH SEE ALSO\n.BR stribeck (1)\n";
}

std::string main_page(const DescribedCommand& command) {
  std::string out =
      head("stribeck", "friction of machine-tool feed drives: identified, shown, compensated", command);
  out += ".SH SYNOPSIS\n\\fBstribeck\\fR \\fIVERB\\fR [\\fIOPTION\\fR] .\\|.\\|. [\\fIFILE\\fR] .\\|.\\|.\n";
  out += ".SH DESCRIPTION\n" + troff(command.meaning) + "\n.SH VERBS\n";
  std::string pages;
  for (const DescribedVerb& v : command.verbs) {
    out += fmt::format(".TP\n\\fB{}\\fR\n{}.\n", troff(v.name), troff(v.meaning));
    pages += fmt::format(".BR stribeck\\-{} (1){}\n", v.name, &v == &command.verbs.back() ? "" : ",");
  }
  out += ".SH OPTIONS\n";
  for (const DescribedOption& o : command.options) out += entry(o);
  return out + std::string(kExitStatus) + ".SH SEE ALSO\n" + pages;
}

}  // namespace

DescribedCommand described_command(const CLI::App& app, std::string version) {
  return {app.get_description(), std::move(version), options_of(app), verbs_of(app)};
}

std::vector<std::pair<std::string, std::string>> man_pages(const DescribedCommand& command) {
  std::vector<std::pair<std::string, std::string>> out{{"stribeck.1", main_page(command)}};
  for (const DescribedVerb& v : command.verbs)
    out.emplace_back("stribeck-" + v.name + ".1", verb_page(command, v));
  return out;
}

void write_shell_pages(const std::string& folder, const DescribedCommand& command) {
  const auto write = [&](const std::string& below, const std::string& name, const std::string& text) {
    const std::filesystem::path place = std::filesystem::path(folder) / below;
    std::filesystem::create_directories(place);
    io::write_atomically((place / name).string(), text);
  };
  for (const auto& [name, text] : man_pages(command)) write("man/man1", name, text);
  write("bash-completion/completions", "stribeck", bash_completion(command));
  write("zsh/site-functions", "_stribeck", zsh_completion(command));
  write("fish/vendor_completions.d", "stribeck.fish", fish_completion(command));
}

}  // namespace stribeck::cli
