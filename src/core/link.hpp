// Links and springs.
//
// A straight link has the length l of its chord c. A curved one is an arc through the neighbouring nodes: with the
// second differences of positions a and b at its two nodes,
//
//     l^2 = |c|^2 + (|a|^2 + |b|^2 - a b)/12,
//     V   = EA h (l/h - 1)^2/2 + EI/(6 h^3) (2 |a|^2 + 2 |b|^2 - a b),
//
// which makes waves of tension and of bending exact to the fourth order of the mesh. A Kelvin-Voigt damper acts along
// the chord. At the end of a run, which is hinged, the second difference is zero.
//
// Links with plain bending are as long as their chords, and a node resists the part of its second difference D that is
// across the first axis, along which they run, with EI D/h^3. Taut
// links pull with the same tension whatever their length, and act along the last axis only.
#pragma once

#include "arena.hpp"
#include "element.hpp"

namespace RW_VARIANT {

// Hooke's law with a damper. A spring is a straight link with EA = k L. T: numbers, or vectors of different springs.
template <class T>
struct Axial {
    T stiffness;  // N/m
    T preload;    // N, stiffness times unstrained length
    T damping;    // N s/m
    T floor;      // N/m: 0 if it does not push, else minus infinity
    T scale{};    // 1/m^2, one over the square of the unstrained length; 0: it is not known that strains are small
};

// Forces over length, N/m: of the spring, and of spring and damper.
template <class S>
struct Pull {
    S elastic, total;
};

// Squares of lengths over their unstrained values that differ less from 1 have a series instead of a root.
constexpr double SMALL = 1.0 / 256.0;

// 1 - 1/root(1 + x) for |x| < SMALL: to 4e-13 of itself, as the difference from 1 has it at such strains.
template <class S>
inline S stretch(const S& x) {
    return x * (0.5 - x * (3.0 / 8.0 - x * (5.0 / 16.0 - x * (35.0 / 128.0 - x * (63.0 / 256.0)))));
}

// square: of the length, along: product of the chord and its rate. SURE: all strains are small.
template <bool VISCOUS, bool SURE = false, class T, class S>
inline Pull<S> pull(const Axial<T>& p, const S& square, const S& along) {
    const S x = square * p.scale - 1.0;
    S elastic = p.stiffness * stretch(x);
    if constexpr (!SURE)
        elastic = if_below(x, SMALL, elastic, [&] { return p.stiffness - p.preload * (1.0 / root(square)); });
    S total = elastic;
    if constexpr (VISCOUS) total = total + p.damping * along / square;
    return {unless_below(elastic, p.floor, elastic), unless_below(elastic, p.floor, total)};
}

enum class Kind { STRAIGHT, CURVED, PLAIN, TAUT };

inline Kind kind_of(const Model& m, I64 run) {
    if (m.run_taut[run]) return Kind::TAUT;
    if (m.run_curved[run]) return Kind::CURVED;
    return m.bending_stiffness[run] > 0.0 ? Kind::PLAIN : Kind::STRAIGHT;
}

// Parameters of the links of a run.
struct Links {
    Axial<double> axial;
    double bending;     // N/m, EI/(6 h^3)
    double tension;     // N/m, of taut links, over their length
    bool begins, ends;  // the link is the first, or the last one of its run
};

// Of a node that resists bending alone, over its second difference, N/m: EI/h^3.
inline double plain_moment(const Links& p) { return 6.0 * p.bending; }

inline double floor_of(I64 tension_only) { return tension_only ? 0.0 : -INFINITE; }

// Of the links of run r inside it.
inline Links links_of(const Model& m, I64 r) {
    const double per_length = 1.0 / m.link_length[r], EA = m.axial_stiffness[r];
    const double bending = m.bending_stiffness[r] * per_length * per_length * per_length * (1.0 / 6.0);
    return {{EA * per_length, EA, m.axial_damping[r] * per_length, floor_of(m.run_tension_only[r]),
             per_length * per_length},
            bending,
            m.run_tension[r] * per_length,
            0,
            0};
}

// Of the springs of a band.
inline Axial<double> springs_of(const Model& m, I64 band) {
    const double stiffness = m.band_stiffness[band];
    return {stiffness, stiffness * m.band_length[band], m.band_damping[band], floor_of(m.band_tension_only[band])};
}

// A straight link, or a spring: unknowns are the positions of its two nodes.
template <int AXES>
struct Straight {
    static constexpr int UNKNOWNS = 2 * AXES;

    // Force of a link with chord c and rate of it on its first node; returns the square of its length.
    template <bool VISCOUS, bool SURE = false, class T, class S>
    static inline S resist(const Axial<T>& p, const S* c, const S* rate, S* first) {
        S square{}, along{};
        for (int i = 0; i < AXES; i++) {
            square = square + c[i] * c[i];
            if constexpr (VISCOUS) along = along + c[i] * rate[i];
        }
        const S q = pull<VISCOUS, SURE>(p, square, along).total;
        for (int i = 0; i < AXES; i++) first[i] = q * c[i];
        return square;
    }

    template <class S>
    static void force(const Axial<double>& p, const Context&, const S* x, const S* v, S* f) {
        S c[AXES], rate[AXES], first[AXES];
        for (int i = 0; i < AXES; i++) c[i] = x[AXES + i] - x[i], rate[i] = v[AXES + i] - v[i];
        resist<true>(p, c, rate, first);
        for (int i = 0; i < AXES; i++) {
            f[i] = f[i] + first[i];
            f[AXES + i] = f[AXES + i] - first[i];
        }
    }

    template <class S>
    static S energy(const Axial<double>& p, const Context&, const S* x) {
        S square = 0.0;
        for (int i = 0; i < AXES; i++) square = square + (x[AXES + i] - x[i]) * (x[AXES + i] - x[i]);
        return stored(p, square);
    }

    // Energy of the spring with the square of its length.
    template <class S>
    static S stored(const Axial<double>& p, S square) {
        if (p.stiffness == 0.0) return 0.0;
        const S longer = root(square) - p.preload / p.stiffness;
        return unless_below(longer, p.floor, 0.5 * p.stiffness * longer * longer);
    }
};

// A curved link: unknowns are the positions of the node before it, of its two nodes, and of the one behind it.
template <int AXES>
struct Curved {
    static constexpr int UNKNOWNS = 4 * AXES;

    // Square of the length of a link with chord c and second differences a and b.
    template <class S>
    static inline S square_of(const S* c, const S* a, const S* b) {
        S square{}, bends{};
        for (int i = 0; i < AXES; i++) {
            square = square + c[i] * c[i];
            bends = bends + (a[i] * a[i] + b[i] * (b[i] - a[i]));
        }
        return square + bends * (1.0 / 12.0);
    }

    // Force on its first node, and what acts against its second differences.
    template <class S>
    static inline void act(const Pull<S>& q, double bending, const S* c, const S* a, const S* b, S* first, S* against_a,
                           S* against_b) {
        const S w = q.elastic * (1.0 / 24.0) + bending;
        for (int i = 0; i < AXES; i++) {
            first[i] = q.total * c[i];
            against_a[i] = w * ((a[i] + a[i]) - b[i]) + (2.0 * bending) * a[i];
            against_b[i] = w * ((b[i] + b[i]) - a[i]) + (2.0 * bending) * b[i];
        }
    }

    // Both, of a link with chord c and rate of it; returns the square of its length.
    template <bool VISCOUS, bool SURE = false, class S>
    static inline S resist(const Links& p, const S* c, const S* rate, const S* a, const S* b, S* first, S* against_a,
                           S* against_b) {
        S along{};
        if constexpr (VISCOUS)
            for (int i = 0; i < AXES; i++) along = along + c[i] * rate[i];
        const S square = square_of(c, a, b);
        act(pull<VISCOUS, SURE>(p.axial, square, along), p.bending, c, a, b, first, against_a, against_b);
        return square;
    }

    // Add these to the forces f on its four nodes.
    template <class S>
    static void distribute(const Links& p, const S* first, const S* against_a, const S* against_b, S* f) {
        for (int i = 0; i < AXES; i++) {
            const S m = p.begins ? S(0.0) : against_a[i], n = p.ends ? S(0.0) : against_b[i];
            f[i] = f[i] - m;
            f[AXES + i] = f[AXES + i] + (first[i] + (m + m) - n);
            f[2 * AXES + i] = f[2 * AXES + i] - (first[i] + m - (n + n));
            f[3 * AXES + i] = f[3 * AXES + i] - n;
        }
    }

    // Second differences at its nodes.
    template <class S>
    static void bend(const Links& p, const S* x, S* a, S* b) {
        for (int i = 0; i < AXES; i++) {
            const S before = x[AXES + i] - x[i], c = x[2 * AXES + i] - x[AXES + i];
            const S behind = x[3 * AXES + i] - x[2 * AXES + i];
            a[i] = p.begins ? S(0.0) : c - before;
            b[i] = p.ends ? S(0.0) : behind - c;
        }
    }

    template <class S>
    static void force(const Links& p, const Context&, const S* x, const S* v, S* f) {
        S c[AXES], rate[AXES], a[AXES], b[AXES], first[AXES], against_a[AXES], against_b[AXES];
        bend(p, x, a, b);
        for (int i = 0; i < AXES; i++) {
            c[i] = x[2 * AXES + i] - x[AXES + i];
            rate[i] = v[2 * AXES + i] - v[AXES + i];
        }
        resist<true>(p, c, rate, a, b, first, against_a, against_b);
        distribute(p, first, against_a, against_b, f);
    }

    template <class S>
    static S energy(const Links& p, const Context&, const S* x) {
        S a[AXES], b[AXES], square = 0.0, squares = 0.0, product = 0.0;
        bend(p, x, a, b);
        for (int i = 0; i < AXES; i++) {
            const S c = x[2 * AXES + i] - x[AXES + i];
            square = square + c * c;
            squares = squares + (a[i] * a[i] + b[i] * b[i]);
            product = product + a[i] * b[i];
        }
        const S stretched = Straight<AXES>::stored(p.axial, square + (squares - product) * (1.0 / 12.0));
        return stretched + p.bending * (2.0 * squares - product);
    }
};

// A link whose nodes resist bending alone, or a taut one: unknowns as above.
template <int AXES, bool TAUT>
struct Plain {
    static constexpr int UNKNOWNS = 4 * AXES;

    static constexpr bool bends(int axis) { return axis > 0 && (!TAUT || axis == AXES - 1); }

    template <class S>
    static void force(const Links& p, const Context&, const S* x, const S* v, S* f) {
        S c[AXES], rate[AXES], a[AXES], b[AXES], first[AXES];
        Curved<AXES>::bend(p, x, a, b);
        for (int i = 0; i < AXES; i++) {
            c[i] = x[2 * AXES + i] - x[AXES + i];
            rate[i] = v[2 * AXES + i] - v[AXES + i];
        }
        if constexpr (!TAUT) Straight<AXES>::template resist<true>(p.axial, c, rate, first);
        for (int i = 0; i < AXES; i++) {
            if (TAUT) first[i] = i < AXES - 1 ? S(0.0) : p.tension * c[i];
            // each node shares its moment with the next link
            a[i] = (bends(i) ? 0.5 * plain_moment(p) : 0.0) * a[i];
            b[i] = (bends(i) ? 0.5 * plain_moment(p) : 0.0) * b[i];
        }
        Curved<AXES>::distribute(p, first, a, b, f);
    }

    template <class S>
    static S energy(const Links& p, const Context&, const S* x) {
        S a[AXES], b[AXES], square = 0.0, squares = 0.0;
        Curved<AXES>::bend(p, x, a, b);
        for (int i = TAUT ? AXES - 1 : 0; i < AXES; i++) {
            const S c = x[2 * AXES + i] - x[AXES + i];
            square = square + c * c;
            if (bends(i)) squares = squares + (a[i] * a[i] + b[i] * b[i]);
        }
        const S bent = (0.25 * plain_moment(p)) * squares;
        if constexpr (TAUT) return 0.5 * p.tension * square + bent;
        return Straight<AXES>::stored(p.axial, square) + bent;
    }
};

}  // namespace RW_VARIANT
