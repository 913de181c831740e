#pragma once
/// The dashboard as one file: what-if and identification, computed by the browser that opens it, without the program and without a network
/// (docs/decisions/0023-offline-page.md). tools/make-offline-page makes it once; here machine files are put into it.
/// Real time: no.
/// Errors: InputError where the program has no such page.

#include <string>
#include <utility>
#include <vector>

namespace stribeck::web {

/// The page, with machine files (name and text) that it offers before those that are built in.
std::string offline_page(const std::vector<std::pair<std::string, std::string>>& machines);

/// The machine files of a folder that the dashboard would offer.
std::vector<std::pair<std::string, std::string>> machine_files(const std::string& folder);

}  // namespace stribeck::web
