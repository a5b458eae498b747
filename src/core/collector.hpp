// Bodies that press on runs from below where they are along the first axis: collectors on contact wires.
//
// The point z of the run is one of its spline. A force bends a string into a kink, which the spline rounds off: the
// point of the string is higher by N times
//
//     (1/2T) sum_ij w_i w_j |x_i - x_j| = (h/T) sum_k A_k (1 - A_k),   A_k = w_0 + ... + w_k,
//
// the part of its Green's function with a corner. That is a spring in series with the one of the contact.
#pragma once

#include "link.hpp"
#include "stencil.hpp"

namespace RW_VARIANT {

template <int AXES>
struct Collector {
    static constexpr int UNKNOWNS = (SHARED + 1) * AXES, UP = AXES - 1;  // the body comes last
    double weight[SHARED];
    double compliance;  // m/N

    template <class S>
    static S gap(const Collector& p, const S* x) {
        S gap = x[SHARED * AXES + UP];
        for (int k = 0; k < SHARED; k++) gap = gap - p.weight[k] * x[k * AXES + UP];
        return gap;
    }
    template <class S>
    static void force(const Collector& p, const Context&, const S* x, const S*, S* f) {
        const S overlap = gap(p, x), N = unless_below(overlap, 0.0, overlap * (1.0 / p.compliance));
        for (int k = 0; k < SHARED; k++) f[k * AXES + UP] = f[k * AXES + UP] + p.weight[k] * N;
        f[SHARED * AXES + UP] = f[SHARED * AXES + UP] - N;
    }
    template <class S>
    static S energy(const Collector& p, const Context&, const S* x) {
        const S overlap = gap(p, x);
        return unless_below(overlap, 0.0, overlap * overlap * (0.5 / p.compliance));
    }
};

// Place of x in links along a run whose nodes go on along the first axis; below 0 or beyond the links if it is not
// there.
inline double place_of(const Model& m, const State& s, I64 run, double x) {
    const I64 links = s.run_links[run];
    const double* const at = s.position.at(s.run_first[run], links + 1);
    const double part = (x - at[0]) / (at[links] - at[0]) * static_cast<double>(links);
    if (!(part >= 0.0 && part <= static_cast<double>(links)) || m.run_taut[run]) return part;
    I64 i = locate(links, part).link;
    while (i > 0 && x < at[i]) i--;
    while (i + 1 < links && x > at[i + 1]) i++;
    return static_cast<double>(i) + (x - at[i]) / (at[i + 1] - at[i]);
}

// Tension of link i of a run, N.
template <int AXES>
inline double tension_of(const Model& m, const State& s, I64 run, I64 i) {
    if (m.run_taut[run]) return m.run_tension[run];
    double square = 0.0;
    for (I64 at = s.run_first[run] + i; at < AXES * m.stride; at += m.stride) {
        const double c = s.position[at + 1] - s.position[at];
        square += c * c;
    }
    return pull<false>(links_of(m, run).axial, square, 0.0).elastic * m.link_length[run];
}

// Call visit(parameters, nodes, number) for all bodies that are below their runs.
template <int AXES>
void visit_collectors(const Model& m, const State& s, auto visit) {
    for (I64 k = 0; k < m.collectors; k++) {
        const I64 run = m.collector_run[k], links = s.run_links[run];
        const double place = place_of(m, s, run, s.position[m.collector_body[k]]);
        if (!(place >= 0.0 && place <= static_cast<double>(links))) continue;
        const Cell cell = locate(links, place);
        Collector<AXES> p;
        weigh(cell, place, p.weight);
        double sum = 0.0, corner = 0.0;
        I64 nodes[SHARED + 1];
        for (I64 j = 0; j < SHARED; j++) {
            sum += p.weight[j], corner += sum * (1.0 - sum);
            nodes[j] = s.run_first[run] + (cell.first + j < links ? cell.first + j : links);
        }
        nodes[SHARED] = m.collector_body[k];
        const double T = tension_of<AXES>(m, s, run, cell.link);
        p.compliance = 1.0 / m.collector_stiffness[k] + (T > 0.0 ? corner * m.link_length[run] / T : 0.0);
        visit(p, nodes, k);
    }
}

}  // namespace RW_VARIANT
