// A rope over a sheave that is a point. Between the last node of the run up to it and the first one of the next run are
// two straight pieces of the unstrained lengths s and 2 h - s, where h is that of a link:
//
//     V = s W(l1/s - 1) + (2 h - s) W(l2/(2 h - s) - 1) + what the pieces weigh, W = EA e^2/2.
//
// The split s is a coordinate like those of nodes, with the mass of a link, which flows over the sheave. Without
// friction the force on it, -dV/ds, is nothing where both tensions are equal. It is smooth: s stays near h, as a node
// that comes close leaves its run and enters the other one as far behind the sheave (pass_nodes).
#pragma once

#include "elementary.hpp"
#include "link.hpp"

namespace RW_VARIANT {

// Parameters of both pieces. Weight is per unstrained length.
struct Pieces {
    double stiffness, damping, floor, link;  // N, N s, N, m
    double weight[3];
};

inline Pieces pieces_of(const Model& m, I64 sheave) {
    const I64 run = m.sheave_run[sheave];
    Pieces p{m.axial_stiffness[run], m.axial_damping[run], floor_of(m.run_tension_only[run]), m.link_length[run], {}};
    for (I64 axis = 0; axis < m.axes; axis++) p.weight[axis] = m.sheave_weight[axis * stride_of(m.sheaves) + sheave];
    return p;
}

// Unknowns are the positions of the node before the sheave, of the sheave, of the node behind it, and the split.
template <int AXES>
struct OverSheave {
    static constexpr int UNKNOWNS = 3 * AXES + 1;
    static constexpr int LAST = 2 * AXES, SPLIT = 3 * AXES;  // first unknown of the last node; the split

    // Force of a piece with chord c and length s on its first node; returns that on s.
    template <class S>
    static S resist(const Pieces& p, const S* c, const S* rate, const S& s, const S& growth, S* first) {
        S square = 0.0, along = 0.0;
        for (int i = 0; i < AXES; i++) square = square + c[i] * c[i], along = along + c[i] * rate[i];
        const S length = root(square), stretch = length / s, elastic = p.stiffness * (stretch - 1.0);
        const S viscous = p.damping * ((along / length - stretch * growth) / s);
        const S pull = unless_below(elastic, p.floor, elastic + viscous) / length;
        for (int i = 0; i < AXES; i++) first[i] = pull * c[i];
        return unless_below(elastic, p.floor, 0.5 * elastic * (1.0 + stretch) + viscous * stretch);
    }

    template <class S>
    static void force(const Pieces& p, const Context&, const S* x, const S* v, S* f) {
        S c[AXES], d[AXES], rate[AXES], other[AXES], near[AXES], far[AXES];
        for (int i = 0; i < AXES; i++) {
            c[i] = x[AXES + i] - x[i], d[i] = x[2 * AXES + i] - x[AXES + i];
            rate[i] = v[AXES + i] - v[i], other[i] = v[2 * AXES + i] - v[AXES + i];
        }
        const S s = x[SPLIT], growth = v[SPLIT];
        S on_split = resist(p, c, rate, s, growth, near) - resist(p, d, other, 2.0 * p.link - s, -growth, far);
        for (int i = 0; i < AXES; i++) {
            const S more = 0.5 * p.weight[i] * (s - p.link);  // than half of a link at the node before the sheave
            on_split = on_split - 0.5 * p.weight[i] * (c[i] + d[i]);
            f[i] = f[i] + near[i] + more;
            f[AXES + i] = f[AXES + i] + far[i] - near[i];
            f[2 * AXES + i] = f[2 * AXES + i] - far[i] - more;
        }
        f[SPLIT] = f[SPLIT] + on_split;
    }

    template <class S>
    static S stored(const Pieces& p, const S* begin, const S* end, const S& s) {
        S square = 0.0;
        for (int i = 0; i < AXES; i++) square = square + (end[i] - begin[i]) * (end[i] - begin[i]);
        const S strain = root(square) / s - 1.0;
        return unless_below(p.stiffness * strain, p.floor, 0.5 * p.stiffness * s * strain * strain);
    }

    // Infinite where a piece would have no length.
    template <class S>
    static S energy(const Pieces& p, const Context&, const S* x) {
        const S s = x[SPLIT], rest = 2.0 * p.link - s;
        if (!(value_of(s) > 0.0 && value_of(rest) > 0.0)) return INFINITE;
        S sum = stored(p, x, x + AXES, s) + stored(p, x + AXES, x + LAST, rest);
        for (int i = 0; i < AXES; i++) sum = sum + 0.5 * p.weight[i] * (s - p.link) * (x[2 * AXES + i] - x[i]);
        return sum;
    }
};

// Of a sheave: tensions before and behind it, the angle by which the rope turns, and the most that friction bears of
// the force on the split.
struct AtSheave {
    double before, behind, angle, most;
};

// Euler and Eytelwein: the rope slips where one tension is exp(mu angle) times the other.
template <int AXES>
inline AtSheave at_sheave(const Pieces& p, double friction, const double* x) {
    double length[2], weight[2]{}, sum = 0.0, difference = 0.0;
    for (int side = 0; side < 2; side++) {
        double square = 0.0;
        for (int i = 0; i < AXES; i++) {
            const double way = x[AXES + i] - x[2 * side * AXES + i];
            square += way * way;
            weight[side] += 0.5 * p.weight[i] * way;
        }
        length[side] = root(square);
    }
    for (int i = 0; i < AXES; i++) {
        const double one = (x[AXES + i] - x[i]) / length[0], other = (x[2 * AXES + i] - x[AXES + i]) / length[1];
        sum += (one + other) * (one + other), difference += (one - other) * (one - other);
    }
    const double s = x[OverSheave<AXES>::SPLIT], split[] = {s, 2.0 * p.link - s};
    double middle[2], tension[2];
    for (int side = 0; side < 2; side++) {
        const double elastic = p.stiffness * (length[side] / split[side] - 1.0);
        middle[side] = unless_below(elastic, p.floor, elastic);
        tension[side] = middle[side] - weight[side];
    }
    const int low = tension[0] <= tension[1] ? 0 : 1;
    const double angle = 2.0 * atan2(root(difference), root(sum));
    const double high = exp(friction * angle) * tension[low], other = high + weight[1 - low];
    const double most = high - tension[low] + (other * other - middle[low] * middle[low]) * 0.5 / p.stiffness;
    return {tension[0], tension[1], angle, tension[low] > 0.0 && friction > 0.0 ? most : 0.0};
}

}  // namespace RW_VARIANT
