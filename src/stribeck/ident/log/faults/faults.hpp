#pragma once
/// Faults of logs that one channel alone does not tell of. Steps of condition(), inside of it only.
///
/// Real time: no.

#include <array>
#include <cstddef>
#include <stribeck/ident/log/condition_parts.hpp>
#include <string>
#include <vector>

namespace stribeck::ident::log::parts {

inline constexpr std::size_t kMostLost = 5;  ///< rows in one place that are put in again

inline constexpr double kGap = 1.5;           ///< steps: a longer one is a gap
inline constexpr double kLeastJitter = 0.02;  ///< of a step, in a tenth of the rows: stamps that jitter

// jitter.cpp
/// What a tenth of the steps are off by, as a share of a step.
double usual_jitter(const std::vector<double>& t, double step);
/// Largest distance of the stamps from a straight line between their ends [s].
double largest_off_line(const std::vector<double>& t);
/// Whether rows whose stamps jitter were taken evenly all the same, as by a control whose rows a computer stamps when they arrive.
bool taken_evenly(const Table& part);
/// Mends stamps that jitter: those in the wrong order, and those so late that a row seems to be missing. Where rows are missing among
/// them and the others were taken evenly, all get the times of their numbers.
void mend_jittering_stamps(Table& table, Notes& notes);

// short_gaps.cpp
/// Puts in up to kMostLost rows that are missing in one place, time stamps included, and marks them as not fitted. Longer gaps
/// stay, as do those that the motion does not have.
void bridge_short_gaps(Table& table, Sampling& sampling, Notes& notes);
/// Value at the time `at` on the cubic through four samples y at the times t, two before a hole and two after it.
double on_cubic(const std::array<double, 4>& t, const std::array<double, 4>& y, double at);

// lost_rows.cpp
/// Puts in rows that a logger lost, takes out those that it wrote twice, and mends those that it did not renew,
/// where the time stamps were numbered afterwards and say nothing of it.
void mend_lost_rows(std::vector<Table>& tables, const Sampling& sampling, Notes& notes);

// jumps.cpp
/// Cuts where the position jumps between two rows while the speed before and after is the same, and where the speed
/// itself jumps.
std::vector<Table> cut_at_jumps(std::vector<Table> tables, const Sampling& sampling, Notes& notes);

// wrapped.cpp
/// Makes positions continuous that begin again at each turn or at each period of a counter.
void unwrap_positions(std::vector<RawLog>& runs, Notes& notes);

// force_spikes.cpp
/// Replaces single wild values of the force to which the motion does not answer.
void mend_force_spikes(std::vector<Table>& tables, Notes& notes);

// late_force.cpp
/// Moves a force that is later or earlier than the motion by more than a drive delays it, and stretches one of another clock, in logs
/// with a reference.
void align_late_force(std::vector<Table>& tables, Notes& notes);

// exchanged.cpp
/// Changes position and reference back where the position leads and only the reference has noise.
void mend_exchanged(std::vector<Table>& tables, Notes& notes);

// commanded.cpp
/// Says where the position is its reference, or in a log without one is smoother than any loop makes it.
void name_commanded_position(const std::vector<Table>& tables, const RoughFit& rough, Notes& notes);

// plausible.cpp
/// Refuses a speed or a mass that no machine has, and doubts one that few have.
void refuse_implausible_drive(const Coverage& coverage, const RoughFit& rough, const std::string& source,
                              const std::string& force_unit, const std::string& position_unit, Notes& notes);

// smoothed_force.cpp
/// Says where the force was smoothed before it was logged, and where it swings at one frequency.
void name_smoothed_force(const std::vector<Table>& tables, Notes& notes);

}  // namespace stribeck::ident::log::parts
