#pragma once
/// What an installation puts beside the program: man pages, and completion for bash, zsh and fish. All of it is made from the
/// declarations that --help prints (described.hpp).
/// Real time: no.

#include <apps/cli/shell/described.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stribeck::cli {

/// What a page needs of the command, read while the command still exists.
struct DescribedCommand {
  std::string meaning;
  std::string version;  ///< "stribeck 0.1.0"
  std::vector<DescribedOption> options;
  std::vector<DescribedVerb> verbs;
};

DescribedCommand described_command(const CLI::App& app, std::string version);

std::string bash_completion(const DescribedCommand& command);
std::string zsh_completion(const DescribedCommand& command);
std::string fish_completion(const DescribedCommand& command);

/// (file name, text) of stribeck.1 and stribeck-VERB.1.
std::vector<std::pair<std::string, std::string>> man_pages(const DescribedCommand& command);

/// Writes all of them below the folder, laid out as below /usr/share.
void write_shell_pages(const std::string& folder, const DescribedCommand& command);

}  // namespace stribeck::cli
