/// The laws for three and five axes.
#include <stribeck/sim/law/law_runner_of.hpp>

namespace stribeck::sim {
template AnyController<3> make_controller<3>(const control::LawParams&, const control::Setup<3>&);
template AnyController<5> make_controller<5>(const control::LawParams&, const control::Setup<5>&);
}  // namespace stribeck::sim
