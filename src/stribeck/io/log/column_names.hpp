#pragma once
/// Names of columns as logs write them, in any case of their letters.
/// Real time: no.

#include <array>
#include <string>
#include <string_view>

namespace stribeck::io {

/// Letters of ASCII become small ones.
std::string lower_case(std::string text);

/// What a column that holds the time is called, in lower case.
inline constexpr std::array<std::string_view, 17> kTimeNames{
    "t",      "ts",    "time",    "zeit",         "timestamp", "zeitstempel",
    "temps",  "tempo", "elapsed", "elapsed time", "stamp",     "__time",
    "tiempo", "時間",  "时间",    "時刻",         "经过时间"};

}  // namespace stribeck::io
