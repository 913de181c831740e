#pragma once
/// A zip archive with compressed files, in memory.
///
/// Every file has the date 1980-01-01: the same files are the same bytes. For a few megabytes, without comments or encryption.
/// Source: PKWARE, APPNOTE 6.3, sections 4.3.7 to 4.3.16.
/// Real time: no.

#include <string>
#include <utility>
#include <vector>

namespace stribeck::targets {

/// Path in the archive with slashes, and the bytes.
using ZipFile = std::pair<std::string, std::string>;

std::string zip_archive(const std::vector<ZipFile>& files);

}  // namespace stribeck::targets
