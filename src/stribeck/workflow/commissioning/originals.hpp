#pragma once
/// Files of a LinuxCNC configuration that commissioning writes, and the way back.
///
/// FOLDER/originals holds every file as it was before the first change, byte for byte, with its permissions, and originals.json: path,
/// SHA-256 before (empty: there was no file) and of everything that was written. It is complete before the first file changes, so that an
/// interrupted change can be undone as well. Files that somebody else has changed since are never touched.
/// Real time: no.
/// Errors: InputError naming the file.

#include <string>
#include <utility>
#include <vector>

namespace stribeck::workflow::commissioning {

/// Replaces files, each at once. A second call keeps the originals of the first one, and those of files that are new to it.
void replace_files(const std::string& folder, const std::vector<std::pair<std::string, std::string>>& files);

/// Puts the originals back, removes what was not there, and then the folder of originals. Gives the files that it changed.
std::vector<std::string> restore_files(const std::string& folder);

/// The text of an INI file with one more HALFILE at the end of those of [HAL]; unchanged where it is there already. Empty: it has no HALFILE.
std::string with_halfile(const std::string& ini, const std::string& name);

}  // namespace stribeck::workflow::commissioning
