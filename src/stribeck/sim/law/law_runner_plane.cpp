/// The laws for one and two axes.
#include <stribeck/sim/law/law_runner_of.hpp>

namespace stribeck::sim {
template AnyController<1> make_controller<1>(const control::LawParams&, const control::Setup<1>&);
template AnyController<2> make_controller<2>(const control::LawParams&, const control::Setup<2>&);
}  // namespace stribeck::sim
