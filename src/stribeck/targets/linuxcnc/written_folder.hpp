#pragma once
/// Writes the files of a configuration to a folder; files that a user has edited are never overwritten.
/// Real time: no.
/// Errors: InputError naming the folder and the edited files.

#include <string>
#include <utility>
#include <vector>

namespace stribeck::targets::linuxcnc {

/// Names and texts of files.
using NamedTexts = std::vector<std::pair<std::string, std::string>>;

struct WrittenFolder {
  std::vector<std::string> files;  ///< all that belong to the configuration
  std::vector<std::string>
      kept;  ///< files that a user has edited, and whose text would be the same as before
};

/// Writes files to a folder that exists, and a record of them, written.txt, beginning with the comment. What was edited since the
/// record was made, or is in no record, is never overwritten: kept where the text to write is the recorded one, else refused
/// (InputError), and then nothing is written.
WrittenFolder write_folder(const std::string& folder, const std::string& comment, const NamedTexts& files);

}  // namespace stribeck::targets::linuxcnc
