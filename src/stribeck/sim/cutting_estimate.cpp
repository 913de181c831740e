#include <cmath>
#include <complex>
#include <stribeck/control/observers/cutting_force_observer.hpp>
#include <stribeck/sim/cutting_estimate.hpp>

namespace stribeck::sim {
namespace {

template <std::size_t Waves, std::size_t N>
bool estimate_with(std::vector<ContourSample>& trace, const std::array<double, Waves>& frequency,
                   const control::Setup<N>& setup) {
  using Observer = control::CuttingForceObserver<Waves>;
  for (std::size_t i = 0; i < N; ++i) {
    typename Observer::Params params;
    params.model = setup.compensation[i].model;
    params.frequency = frequency;
    params.period = setup.period;
    if (!params.determinable()) return false;
    const Observer observer(params);
    typename Observer::State state;
    const ContourSample* before = &trace.front();
    for (ContourSample& s : trace) {
      observer.step(state, before->force[i], before->reference[i], before->velocity[i], s.encoder[i]);
      s.cutting_estimate[i] = observer.coming(state);
      before = &s;
    }
  }
  return true;
}

}  // namespace

template <std::size_t N>
void estimate_cutting(std::vector<ContourSample>& trace, const CuttingForce& cutting,
                      const control::Setup<N>& setup) {
  if (trace.empty()) return;
  const double turn = cutting.turn_frequency();
  const double tooth = turn * cutting.teeth;
  if (estimate_with<2, N>(trace, {turn, tooth}, setup)) return;
  if (estimate_with<1, N>(trace, {turn}, setup)) return;
  estimate_with<0, N>(trace, {}, setup);
}

CuttingFigures cutting_figures(const std::vector<ContourSample>& trace, const CuttingForce& cutting) {
  struct Sums {
    double plain = 0.0;
    std::complex<double> turn;
    std::complex<double> tooth;

    void add(double force, double t, double omega, double teeth) {
      plain += force;
      turn += force * std::polar(1.0, -omega * t);
      tooth += force * std::polar(1.0, -omega * teeth * t);
    }
    [[nodiscard]] CuttingFigures::Of over(double n) const {
      return {plain / n, 2.0 * std::abs(turn) / n, 2.0 * std::abs(tooth) / n};
    }
  };
  Sums truth;
  Sums estimate;
  double square = 0.0;
  double square_error = 0.0;
  double n = 0.0;
  for (const ContourSample& s : trace) {
    const double speed = norm(s.velocity);
    if (!s.scored || speed == 0.0) continue;
    const double is = dot(s.cutting, s.velocity) / speed;
    const double seen = dot(s.cutting_estimate, s.velocity) / speed;
    truth.add(is, s.time, cutting.turn_frequency(), cutting.teeth);
    estimate.add(seen, s.time, cutting.turn_frequency(), cutting.teeth);
    square += is * is;
    square_error += (seen - is) * (seen - is);
    n += 1.0;
  }
  return {truth.over(n), estimate.over(n), std::sqrt(square / n), std::sqrt(square_error / n)};
}

template void estimate_cutting<1>(std::vector<ContourSample>&, const CuttingForce&, const control::Setup<1>&);
template void estimate_cutting<2>(std::vector<ContourSample>&, const CuttingForce&, const control::Setup<2>&);
template void estimate_cutting<3>(std::vector<ContourSample>&, const CuttingForce&, const control::Setup<3>&);
template void estimate_cutting<5>(std::vector<ContourSample>&, const CuttingForce&, const control::Setup<5>&);

}  // namespace stribeck::sim
