#pragma once
/// The files of the dashboard's pages, embedded from page/ at build time.
/// Real time: no.

#include <span>
#include <string_view>

namespace stribeck::web {

struct Asset {
  std::string_view path;  ///< "/what-if.js"
  std::string_view type;
  std::string_view text;
};

std::span<const Asset> assets();

}  // namespace stribeck::web
