// Elements between single nodes. An element here works in every mode: steps, equilibria, spectra and implicit motion
// visit all of them and call `force`. Runs and springs, which are many, have loops of their own in a step.
#pragma once

#include "sheave.hpp"

namespace RW_VARIANT {

// A spring with free play: it pushes below one length, pulls above another one, and has no force in between.
template <int AXES>
struct FreePlay {
    static constexpr int UNKNOWNS = 2 * AXES;
    double stiffness, shortest, longest;

    // The spring that acts at positions x: at the nearer end of the free play, without stiffness inside it.
    Axial<double> spring_at(const auto* x) const {
        double square = 0.0;
        for (int i = 0; i < AXES; i++) square += value_of((x[AXES + i] - x[i]) * (x[AXES + i] - x[i]));
        const double length = root(square), EA = length < shortest ? stiffness * shortest : stiffness * longest;
        const bool is_free = length >= shortest && length <= longest;
        return {is_free ? 0.0 : stiffness, EA, 0.0, -INFINITE};
    }
    static void force(const FreePlay& p, const Context& c, const auto* x, const auto* v, auto* f) {
        const Axial<double> spring = p.spring_at(x);
        if (spring.stiffness != 0.0) Straight<AXES>::force(spring, c, x, v, f);
    }
    static double energy(const FreePlay& p, const Context& c, const double* x) {
        return Straight<AXES>::energy(p.spring_at(x), c, x);
    }
};

// Call visit<E>(number, parameters, nodes) for every sheave.
template <int AXES, class Visit>
void visit_sheaves(const Model& m, const State& s, Visit visit) {
    for (I64 q = 0; q < m.sheaves; q++) {
        const I64 last = s.run_first[m.sheave_run[q]] + s.run_links[m.sheave_run[q]];
        const I64 nodes[] = {last, m.sheave_node[q], last + 1, m.sheave_split[q]};
        visit.template operator()<OverSheave<AXES>>(q, pieces_of(m, q), nodes);
    }
}

// Call visit<E>(parameters, nodes) for every element E between single nodes but springs.
template <int AXES, class Visit>
void visit_others(const Model& m, const State& s, Visit visit) {
    for (I64 k = 0; k < m.counts[PLAYS]; k++) {
        const double shortest = m.play_shortest[k];
        const FreePlay<AXES> p{m.play_stiffness[k], shortest, shortest + m.play_width[k]};
        const I64 nodes[] = {m.play_begin[k], m.play_end[k]};
        visit.template operator()<FreePlay<AXES>>(p, nodes);
    }
    visit_sheaves<AXES>(
        m, s, [&]<class E>(I64, const Pieces& p, const I64* nodes) { visit.template operator()<E>(p, nodes); });
}

// Values (axis, node) of an array with rows of so many numbers at the nodes of an element.
template <class E, int AXES>
inline void gather(const auto& from, I64 stride, const I64* nodes, double* values) {
    for (int axis = 0; axis < AXES; axis++)
        for (int i = axis; i < E::UNKNOWNS; i += AXES) values[i] = from[axis * stride + nodes[i / AXES]];
}
template <class E, int AXES>
inline void scatter(const double* values, I64 stride, const I64* nodes, const auto& to) {
    for (int axis = 0; axis < AXES; axis++)
        for (int i = axis; i < E::UNKNOWNS; i += AXES) to[axis * stride + nodes[i / AXES]] += values[i];
}

}  // namespace RW_VARIANT
