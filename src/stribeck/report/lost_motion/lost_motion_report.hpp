#pragma once
/// Lost motion of an axis, for people and for programs: lost motion, backlash and wind-up with their intervals, and what the log does not
/// determine.
/// Real time: no.

#include <nlohmann/json_fwd.hpp>
#include <stribeck/ident/lost_motion/lost_motion.hpp>
#include <stribeck/report/html.hpp>
#include <string>

namespace stribeck::report {

Table lost_motion_table(const ident::lost_motion::LostMotion& found);
std::string lost_motion_text(const ident::lost_motion::LostMotion& found);
nlohmann::ordered_json lost_motion_json(const ident::lost_motion::LostMotion& found);

/// What a quantity of it means, one sentence.
inline constexpr const char* kLostMotionMeaning =
    "Lost motion is what the table stays behind after a reversal: the backlash, and the wind-up under the table's friction both ways.";

}  // namespace stribeck::report
