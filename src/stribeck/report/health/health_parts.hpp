#pragma once
/// Words and numbers that text, JSON and page of health share. Inside report only. Real time: no.

#include <stribeck/report/health/health_report.hpp>
#include <string>

namespace stribeck::report {

/// "changed", "drifted", "test again", "ok", or "too few tests".
std::string status_of(const ident::health::Channel& channel);
/// "−12.3 %", "+0.4 %".
std::string percent(double share, int digits = 1);
/// "2026-04-02", or with the interval in which it may lie.
std::string when(const ident::health::Change& change);
/// "step" or "slow change", whether it is within its limits or was taken back.
std::string kind_of(const ident::health::Change& change);
/// The numbers that changed with it, the largest first.
std::string effects_of(const ident::health::Change& change,
                       const std::vector<ident::health::Channel>& channels);
/// "120 tests from 2026-01-01 to 2026-04-30".
std::string tests_of(const HealthAxis& axis);
/// What the newest tests show that are too few for a change, and what to do, as one sentence; empty: nothing.
std::string pending_of(const HealthAxis& axis);
/// " (of viscous friction without temperatures 50 %)", of numbers whose slow change has another limit; empty: none.
std::string further_limits(const HealthReportInput& input);
/// What the changes in percent are shares of, as sentences.
std::string shares_of(const HealthReportInput& input);
/// The verdict on one axis in one sentence.
std::string verdict_of(const HealthAxis& axis);

}  // namespace stribeck::report
