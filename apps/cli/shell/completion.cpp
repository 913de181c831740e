#include <fmt/format.h>
#include <string>
#include <string_view>

#include <apps/cli/shell/shell_pages.hpp>

namespace stribeck::cli {
namespace {

constexpr std::string_view kMadeBy =
    "# Made by `stribeck reference --install` from the declarations of the options.\n";

std::string names_together(const std::vector<std::string>& names, std::string_view between) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : std::string(between)) + name;
  return out;
}

std::string all_names(const std::vector<DescribedOption>& options) {
  std::string out;
  for (const DescribedOption& o : options) {
    if (!o.positional) out += (out.empty() ? "" : " ") + names_together(o.names, " ");
  }
  return out;
}

/// In single quotes, for a shell in which nothing but \ and ' means something there.
std::string quoted(std::string_view text, bool fish) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') {
      out += fish ? "\\'" : "'\\''";
    } else if (c == '\\' && fish) {
      out += "\\\\";
    } else {
      out += c;
    }
  }
  return out + "'";
}

// ---- bash

/// The answer for a value: words, files, folders or nothing.
std::string bash_answer(const DescribedOption& o) {
  switch (o.offers) {
    case Offers::kWords:
      return fmt::format("words='{}'", names_together(o.words, " "));
    case Offers::kFiles:
      return "kind=files";
    case Offers::kFolders:
      return "kind=folders";
    case Offers::kNothing:
      return "kind=nothing";
  }
  return {};
}

std::string bash_verb(const DescribedVerb& verb) {
  std::string out =
      fmt::format("    {})\n      options='{}'\n      case $prev in\n", verb.name, all_names(verb.options));
  std::string rest = "kind=nothing";
  for (const DescribedOption& o : verb.options) {
    if (o.positional) {
      rest = bash_answer(o);
    } else if (!o.value.empty()) {
      out += fmt::format("        {}) {} ;;\n", names_together(o.names, " | "), bash_answer(o));
    }
  }
  return out + fmt::format("        *) {} ;;\n      esac\n      ;;\n", rest);
}

// ---- zsh

/// Text inside a specification of _arguments: a colon, a bracket and a backslash mean something there.
std::string zsh_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (std::string_view(":[]\\").find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

std::string zsh_action(const DescribedOption& o) {
  switch (o.offers) {
    case Offers::kWords:
      return fmt::format("({})", names_together(o.words, " "));
    case Offers::kFiles:
      return "_files";
    case Offers::kFolders:
      return "_files -/";
    case Offers::kNothing:
      return " ";
  }
  return {};
}

/// The message above the offered values: the value without its list of words.
std::string zsh_message(const DescribedOption& o) {
  const std::string text = o.offers == Offers::kWords ? o.value.substr(0, o.value.find('{')) : o.value;
  return zsh_text(text.empty() ? "value" : text);
}

std::string zsh_spec(const DescribedOption& o) {
  if (o.positional) {
    return quoted(fmt::format("{}:{}:{}", o.repeatable ? "*" : "", zsh_text(o.names.front()), zsh_action(o)),
                  false);
  }
  std::string out;
  for (const std::string& name : o.names) {
    std::string spec = o.repeatable ? "*" : fmt::format("({})", names_together(o.names, " "));
    spec += name;
    if (!o.value.empty()) spec += name.starts_with("--") ? "=" : "+";
    spec += fmt::format("[{}]", zsh_text(in_short(o.meaning)));
    if (!o.value.empty()) spec += fmt::format(":{}:{}", zsh_message(o), zsh_action(o));
    out += (out.empty() ? "" : " ") + quoted(spec, false);
  }
  return out;
}

std::string zsh_specs(const std::vector<DescribedOption>& options, std::string_view indent) {
  std::string out;
  for (const DescribedOption& o : options) out += fmt::format(" \\\n{}{}", indent, zsh_spec(o));
  return out;
}

// ---- fish

std::string fish_names(const DescribedOption& o) {
  std::string out;
  for (const std::string& name : o.names)
    out += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  return out;
}

std::string fish_answer(const DescribedOption& o) {
  switch (o.offers) {
    case Offers::kWords:
      return " -x -a " + quoted(names_together(o.words, " "), true);
    case Offers::kFiles:
      return " -r -F";
    case Offers::kFolders:
      return " -x -a '(__fish_complete_directories)'";
    case Offers::kNothing:
      return o.value.empty() ? "" : " -x";
  }
  return {};
}

std::string fish_option(const std::string& when, const DescribedOption& o) {
  const std::string head = fmt::format("complete -c stribeck -n {}", quoted(when, true));
  if (!o.positional)
    return fmt::format("{}{}{} -d {}\n", head, fish_names(o), fish_answer(o),
                       quoted(in_short(o.meaning), true));
  if (o.offers == Offers::kNothing) return {};
  if (o.offers == Offers::kWords)
    return fmt::format("{} -a {}\n", head, quoted(names_together(o.words, " "), true));
  return head + " -F\n";
}

}  // namespace

std::string bash_completion(const DescribedCommand& command) {
  std::string verbs;
  for (const DescribedVerb& v : command.verbs) verbs += v.name + " ";
  std::string out = std::string("# bash completion for stribeck.\n") + std::string(kMadeBy) +
                    R"(_stribeck() {
  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD - 1]} options='' words='' kind=''
  # Bash takes --option=value apart at the equals sign, and AXIS=FILE as well.
  if [[ $cur == '=' ]]; then
    cur=''
  elif [[ $prev == '=' ]]; then
    prev=${COMP_WORDS[COMP_CWORD - 2]}
    if [[ $prev != -* ]]; then prev=${COMP_WORDS[COMP_CWORD - 3]}; fi
  fi
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
)" + fmt::format("    COMPREPLY=($(compgen -W '{}{}' -- \"$cur\"))\n", verbs, all_names(command.options)) +
                    "    compopt +o default\n    return\n  fi\n  case ${COMP_WORDS[1]} in\n";
  for (const DescribedVerb& v : command.verbs) out += bash_verb(v);
  return out + R"(    *) return ;;
  esac
  if [[ $cur == -* ]]; then words=$options; fi
  if [[ -n $words ]]; then
    COMPREPLY=($(compgen -W "$words" -- "$cur"))
    compopt +o default
  elif [[ $kind == folders ]]; then
    compopt +o default -o dirnames
  elif [[ $kind == nothing ]]; then
    compopt +o default
  fi
}
complete -o default -F _stribeck stribeck
)";
}

std::string zsh_completion(const DescribedCommand& command) {
  std::string out = "#compdef stribeck\n" + std::string(kMadeBy) +
                    "_stribeck() {\n"
                    "  local curcontext=$curcontext state line\n"
                    "  local -A opt_args\n"
                    "  local -a verbs\n  verbs=(\n";
  for (const DescribedVerb& v : command.verbs)
    out += fmt::format("    {}\n", quoted(v.name + ":" + zsh_text(in_short(v.meaning)), false));
  out += "  )\n  _arguments -C" + zsh_specs(command.options, "    ") +
         " \\\n    '1: :->verb' \\\n    '*:: :->argument'\n  case $state in\n"
         "    verb) _describe -t verbs verb verbs ;;\n"
         "    argument)\n      case $words[1] in\n";
  for (const DescribedVerb& v : command.verbs)
    out += fmt::format("        {})\n          _arguments{}\n          ;;\n", v.name,
                       zsh_specs(v.options, "            "));
  return out +
         "      esac\n      ;;\n  esac\n}\n"
         "if [[ $funcstack[1] == _stribeck ]]; then _stribeck \"$@\"; else compdef _stribeck stribeck; fi\n";
}

std::string fish_completion(const DescribedCommand& command) {
  constexpr const char* kBefore = "__fish_use_subcommand";
  std::string out = "# fish completion for stribeck.\n" + std::string(kMadeBy) + "complete -c stribeck -f\n";
  for (const DescribedOption& o : command.options) out += fish_option(kBefore, o);
  for (const DescribedVerb& v : command.verbs) {
    out += fmt::format("complete -c stribeck -n '{}' -a {} -d {}\n", kBefore, v.name,
                       quoted(in_short(v.meaning), true));
  }
  for (const DescribedVerb& v : command.verbs) {
    for (const DescribedOption& o : v.options) out += fish_option("__fish_seen_subcommand_from " + v.name, o);
  }
  return out;
}

}  // namespace stribeck::cli
