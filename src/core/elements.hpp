// Elements between single nodes. An element here works in every mode: steps, equilibria, spectra and implicit motion
// visit all of them and call `force`. Runs and springs, which are many, have loops of their own in a step.
#pragma once

#include "arena.hpp"
#include "element.hpp"

namespace RW_VARIANT {

// Call visit<E>(parameters, nodes) for every element E between single nodes but springs.
template <int AXES, class Visit>
void visit_others(const Model& m, const State& s, Visit visit) {
    (void)m, (void)s, (void)visit;
}

// Values (axis, node) of an array with rows of so many numbers at the nodes of an element.
template <class E, int AXES>
inline void gather(const auto& from, I64 stride, const I64* nodes, double* values) {
    for (int i = 0; i < E::UNKNOWNS; i++) values[i] = from[i % AXES * stride + nodes[i / AXES]];
}
template <class E, int AXES>
inline void scatter(const double* values, I64 stride, const I64* nodes, const auto& to) {
    for (int i = 0; i < E::UNKNOWNS; i++) to[i % AXES * stride + nodes[i / AXES]] += values[i];
}

}  // namespace RW_VARIANT
