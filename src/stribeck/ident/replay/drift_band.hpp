#pragma once
/// How far a free replay may drift: the interval that the error of the force, as the record shows it, makes around it.
///
///   m·δv̇ + B(v)·δv = e      δẋ = δv      B slope of friction along the measured motion
///
/// A free replay keeps every error of the force for ever; a drift alone says nothing about the model. Here the error
/// of the force, its blocks in random order and with a random sign, drives the deviation again and again; 95 % of the
/// sizes lie within the band. At a reversal the level of friction acts as damping: 2·level/(m·|a|) of a deviation is
/// lost there. Where friction falls with speed, B < 0 and a deviation grows: `growth` is ln of the most that one does.
///
/// Source: Politis, Romano 1994, doi:10.1080/01621459.1994.10476870 (blocks of random length).
/// Not modelled: deviations so large that friction differs along the two motions. Real time: no.

#include <cstddef>
#include <stribeck/ident/replay/model_force.hpp>
#include <stribeck/ident/replay/replay.hpp>
#include <vector>

namespace stribeck::ident::replay {

struct DriftBand {
  std::vector<std::size_t> row;  ///< of the record, at most 400 of them
  std::vector<double> half;      ///< half width of 95 % there [m]
  double end = kNaN;             ///< the same at the last row [m]; NaN: the record is too short
  double inside = kNaN;          ///< share of these rows at which the free replay is within it
  double growth = 0.0;           ///< ln of the factor by which a deviation of the velocity grows at most
};

DriftBand drift_band(const friction::AxisModel& model, const log::Record& record, const ForceError& force,
                     const OpenLoop& open);

}  // namespace stribeck::ident::replay
