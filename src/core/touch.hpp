// The element of a contact: what a load, or a body, and its run do to each other at one point.
//
// The point p of the run is one of its spline (stencil.hpp), with the unit tangent t = p'/|p'|. What touches is at
// x = p + d + e t: d across the line is the tip of the kink (kink.hpp), e is what links give way by along the line,
// which are stretched before the contact and shortened behind it. A kink lengthens the links below, of parts q:
//
//     l^2 += 2 q K,   K = |d|^2/2 h dS/dT,   T: mean of h T/l of the links below by q,
//     V    = |d|^2/2 (S - T dS/dT) + S_a e^2/2 + energy of the links,   S_a = EA/(0.3 h).
//
// V is stationary in T. So forces on nodes and body are its derivatives, if K and T are found together to rounding: by
// Newton's method in doubles, whose last step over any scalar gives the derivatives. A given force has no body: d and
// e are where it balances them. A kink that moves along is softer (moving_stiffness), which has no potential with the
// links: its force does work.
#pragma once

#include "kink.hpp"
#include "link.hpp"

namespace RW_VARIANT {

constexpr I64 BELOW = 3;            // links that bear a kink
constexpr double AXIAL_GIVE = 0.3;  // of h/EA: what a line gives way by along itself

enum class Touching : I64 { NO, YES, LEFT };  // LEFT: beyond an end, with a kink that is not yet straight

// A contact as it has been located, and what has been found there. A row of Workspace::contact_record.
struct Record {
    Touching state;
    I64 run, first, count;  // nodes that share the point
    double weight[SHARED], slope[SHARED], second[SHARED];
    I64 link[BELOW];  // their first nodes
    double part[BELOW], change[BELOW];
    Links links[BELOW];
    Kink kink;
    double length;                     // m, h of the run
    double steepening;                 // 1/m, change of S with the place over S without the compliance of the contact
    double along;                      // N/m, S_a
    double speed;                      // m/s, of the place
    I64 has_body, side;                // side: 0, or 1 above and -1 below the line, where it can only push
    double given[3];                   // N, of a load without a body
    double own[BELOW], others[BELOW];  // m^2, 2 q K, and that of all other contacts that share the links
    double before[BELOW];              // m^2, the same of those whose forces have been added
    double K, square, softer;          // m^2, m^2: |d|^2; N/m: S at rest less S moving
    double force[3], tip[3], push;     // N on the line, m, N: change of all energy with the place
};
static_assert(sizeof(Record) <= 8 * RECORD_SIZE);

template <int AXES>
struct Touch {
    static constexpr int BODY = SHARED * AXES, LINKS = BODY + AXES, LINK = 4 * AXES;
    static constexpr int UNKNOWNS = LINKS + BELOW * LINK;

    // The point, what touches it, and how the links below are stretched.
    template <class S>
    struct Geometry {
        S p[AXES], along[AXES], t[AXES], spread;
        S d[AXES], e, square;  // of a given force: its parts, and the square of that across the line
        S lengths[BELOW];      // squares of the lengths of the links without this kink
        bool is_apart;
    };
    template <class S>
    struct Solution {
        S K, T, moving;  // m^2, N, N/m
        Slope<S> rest;
    };

    template <class S>
    static Geometry<S> measure(const Record& r, const S* x) {
        Geometry<S> g{};
        for (int j = 0; j < BELOW; j++) g.lengths[j] = length_of(r, j, x) + r.others[j];
        if (r.state != Touching::YES) return g;
        S square{};
        for (int i = 0; i < AXES; i++) {
            for (int k = 0; k < SHARED; k++) {
                g.p[i] = g.p[i] + r.weight[k] * x[k * AXES + i];
                g.along[i] = g.along[i] + r.slope[k] * x[k * AXES + i];
            }
            square = square + g.along[i] * g.along[i];
            g.d[i] = r.has_body ? x[BODY + i] - g.p[i] : S(r.given[i]);
        }
        g.spread = root(square);
        for (int i = 0; i < AXES; i++) {
            g.t[i] = g.along[i] / g.spread;
            g.e = g.e + g.d[i] * g.t[i];
        }
        if (!r.has_body && r.along == 0.0) g.e = S(0.0);
        for (int i = 0; i < AXES; i++) {
            g.d[i] = g.d[i] - g.e * g.t[i];
            g.square = g.square + g.d[i] * g.d[i];
        }
        g.is_apart = static_cast<double>(r.side) * value_of(g.d[AXES - 1]) > 0.0;
        return g;
    }

    template <class S>
    static S length_of(const Record& r, int j, const S* x) {
        S c[AXES], a[AXES], b[AXES];
        chord(r, j, x, c, a, b);
        return Curved<AXES>::square_of(c, a, b);
    }
    template <class S>
    static void chord(const Record& r, int j, const S* x, S* c, S* a, S* b) {
        const S* const at = x + LINKS + j * LINK;
        Curved<AXES>::bend(r.links[j], at, a, b);
        for (int i = 0; i < AXES; i++) c[i] = at[2 * AXES + i] - at[AXES + i];
    }

    // T of the links with this kink.
    template <class L, class S>
    static S tension(const Record& r, const L* lengths, const S& K) {
        S sum{};
        for (int j = 0; j < BELOW; j++)
            if (r.part[j] > 0.0)
                sum = sum + r.part[j] * pull<false>(r.links[j].axial, lengths[j] + (2.0 * r.part[j]) * K, S{}).elastic;
        return r.length * sum;
    }

    // What is missing to K, and all that belongs to K. square: of the kink, or of the given force.
    template <class L, class S>
    static S miss(const Record& r, const L* lengths, const L& square, const S& K, Solution<S>& found) {
        found.K = K, found.T = tension(r, lengths, K);
        found.rest = in_series(r.kink.compliance, bare_stiffness(r.kink, found.T));
        found.moving = r.kink.inertia == 0.0 ? found.rest.value : moving_stiffness(r.kink, found.T);
        const S wanted = (0.5 * r.length) * square * found.rest.slope;
        return r.has_body ? K - wanted : K - wanted / (found.moving * found.moving);
    }

    // K and all that belongs to it by Newton's method from r.K. The last step, of at most 3e-8, is taken by derivatives
    // in all numbers, which is right to rounding. `miss` rises with K.
    static Solution<double> solve(const Record& r, const double* lengths, double square) {
        constexpr double SLACK = 5e5, FOUND = 3e-8;
        constexpr int ROUNDS = 60;
        const double unit = r.length * r.length;
        double low = 0.0, high = SLACK * unit, K = square > 0.0 ? r.K : 0.0;
        for (int round = 0; round < ROUNDS && square > 0.0; round++) {
            Solution<Dual<1>> found;
            const Dual<1> missing = miss(r, lengths, square, Dual<1>(K, 0), found);
            const bool bears = r.has_body || found.moving.value > 0.0;
            (bears && missing.value >= 0.0 ? high : low) = K;
            double next = K - missing.value / missing.slope[0];
            if (!bears || (missing.value < -K && !r.has_body && next > 8.0 * K)) next = 4.0 * K + 5e-5 * unit;
            if (!(next >= low && next <= high)) next = 0.5 * (low + high);
            if ((next > K ? next - K : K - next) <= FOUND * next) return changed(found, next);
            K = next;
        }
        Solution<double> found;
        miss(r, lengths, square, K, found);
        return found;
    }
    static Solution<double> changed(const Solution<Dual<1>>& of, double K) {
        const auto at = [&](const Dual<1>& x) { return x.value + x.slope[0] * (K - of.K.value); };
        return {K, at(of.T), at(of.moving), {at(of.rest.value), at(of.rest.slope)}};
    }

    // K is r.K, which `solve` has found; over duals with its derivatives.
    template <class S>
    static Solution<S> complete(const Record& r, const Geometry<S>& g) {
        Solution<S> found;
        const S missing = miss(r, g.lengths, g.square, S(r.K), found);
        if constexpr (!__is_same(S, double)) {
            double lengths[BELOW];
            Solution<Dual<1>> unused;
            for (int j = 0; j < BELOW; j++) lengths[j] = g.lengths[j].value;
            const double rise = miss(r, lengths, g.square.value, Dual<1>(r.K, 0), unused).slope[0];
            S slope = missing * (-1.0 / rise);
            slope.value = r.K;
            miss(r, g.lengths, g.square, slope, found);
        }
        return found;
    }

    // Force N of the contact on its run, and parts of it: d and e where the force is given.
    template <class S>
    struct Pressed {
        S N[AXES], d[AXES], e;
    };
    template <class S>
    static Pressed<S> pressed(const Record& r, const Geometry<S>& g, const S& moving) {
        Pressed<S> found;
        const S give = r.has_body ? S(1.0) : 1.0 / moving;
        found.e = r.has_body || r.along == 0.0 ? g.e : g.e * (1.0 / r.along);
        for (int i = 0; i < AXES; i++) {
            found.d[i] = g.d[i] * give;
            found.N[i] = r.has_body ? moving * g.d[i] + (r.along * g.e) * g.t[i] : S(r.given[i]);
        }
        return found;
    }

    // All that is found at positions x.
    template <class S>
    struct Answer {
        Geometry<S> g;
        Solution<S> found;
        Pressed<S> at;
    };
    // The same with K, which is found.
    static Answer<double> find(Record& r, const double* x) {
        Answer<double> all{measure(r, x), {}, {}};
        if (r.state == Touching::YES && !all.g.is_apart) {
            all.found = solve(r, all.g.lengths, all.g.square);
            all.at = pressed(r, all.g, all.found.moving);
        }
        if (r.state == Touching::YES) r.K = all.found.K;
        return all;
    }
    template <class S>
    static Answer<S> answer(const Record& r, const S* x) {
        Answer<S> all{measure(r, x), {}, {}};
        all.found.K = r.K;
        if (r.state != Touching::YES || all.g.is_apart) return all;
        all.found = complete(r, all.g);
        all.at = pressed(r, all.g, all.found.moving);
        return all;
    }

    template <class S>
    static void force(const Record& r, const Context&, const S* x, const S* v, S* f) {
        apply<true>(r, answer(r, x), x, v, f);
    }
    template <bool VISCOUS, class S>
    static void apply(const Record& r, const Answer<S>& all, const S* x, const S* v, S* f) {
        if (r.state == Touching::NO || all.g.is_apart) return;
        if (r.state == Touching::YES) press(r, all, f);
        for (int j = 0; j < BELOW; j++)
            if (r.part[j] > 0.0) lengthen<VISCOUS>(r, j, all.found.K, x, v, f);
    }

    // Forces on the nodes that share the point and on the body. As t turns with the nodes, N has a moment about p.
    template <class S>
    static void press(const Record& r, const Answer<S>& all, S* f) {
        const Pressed<S>& at = all.at;
        const S moment = (r.along - all.found.moving) * at.e / all.g.spread;
        for (int i = 0; i < AXES; i++) {
            for (int k = 0; k < SHARED; k++)
                f[k * AXES + i] = f[k * AXES + i] + (r.weight[k] * at.N[i] - r.slope[k] * (moment * at.d[i]));
            if (r.has_body) f[BODY + i] = f[BODY + i] - at.N[i];
        }
    }

    // What the forces of a link change by as the kink lengthens it.
    template <bool VISCOUS, class S>
    static void lengthen(const Record& r, int j, const S& K, const S* x, const S* v, S* f) {
        S c[AXES], a[AXES], b[AXES], first[AXES], against_a[AXES], against_b[AXES], along{};
        chord(r, j, x, c, a, b);
        if constexpr (VISCOUS) {
            const S* const rate = v + LINKS + j * LINK;
            for (int i = 0; i < AXES; i++) along = along + c[i] * (rate[2 * AXES + i] - rate[AXES + i]);
        }
        const S without = Curved<AXES>::square_of(c, a, b) + r.before[j];
        const Pull<S> with = pull<VISCOUS>(r.links[j].axial, without + (2.0 * r.part[j]) * K, along);
        const Pull<S> own = pull<VISCOUS>(r.links[j].axial, without, along);
        Curved<AXES>::act({with.elastic - own.elastic, with.total - own.total}, 0.0, c, a, b, first, against_a,
                          against_b);
        Curved<AXES>::distribute(r.links[j], first, against_a, against_b, f + LINKS + j * LINK);
    }

    // With the potential of the given force, which is constant.
    template <class S>
    static S energy(const Record& r, const Context&, const S* x) {
        const Answer<S> all = answer(r, x);
        if (r.state == Touching::NO || all.g.is_apart) return S(0.0);
        S stored{};
        if (r.state == Touching::YES) {
            const Pressed<S>& at = all.at;
            const Slope<S>& rest = all.found.rest;
            S square{};
            for (int i = 0; i < AXES; i++) {
                square = square + at.d[i] * at.d[i];
                if (!r.has_body) stored = stored - r.given[i] * (all.g.p[i] + at.d[i] + at.e * all.g.t[i]);
            }
            stored = stored + 0.5 * square * (rest.value - all.found.T * rest.slope) + 0.5 * r.along * at.e * at.e;
        }
        for (int j = 0; j < BELOW; j++) {
            const S without = length_of(r, j, x) + r.before[j];
            stored = stored + (Straight<AXES>::stored(r.links[j].axial, without + (2.0 * r.part[j]) * all.found.K) -
                               Straight<AXES>::stored(r.links[j].axial, without));
        }
        return stored;
    }

    // Note the force on the run, where it acts, and the change of all energy with the place.
    static void note(Record& r, const Answer<double>& all, const double* x) {
        const Geometry<double>& g = all.g;
        const Solution<double>& found = all.found;
        r.push = r.square = r.softer = 0.0;
        for (int i = 0; i < 3; i++) r.force[i] = r.tip[i] = 0.0;
        double push = 0.0;
        if (r.state == Touching::YES && !g.is_apart) {
            const Pressed<double>& at = all.at;
            const double part = found.rest.value > 0.0 ? 1.0 - r.kink.compliance * found.rest.value : 1.0;
            double turning = 0.0, bent[AXES]{}, back = 0.0;
            for (int i = 0; i < AXES; i++) {
                for (int k = 0; k < SHARED; k++) bent[i] += r.second[k] * x[k * AXES + i];
                back += bent[i] * g.t[i];
            }
            for (int i = 0; i < AXES; i++) {
                r.square += at.d[i] * at.d[i];
                r.force[i] = at.N[i], r.tip[i] = g.p[i] + at.d[i] + at.e * g.t[i];
                turning += at.d[i] * (bent[i] - back * g.t[i]) / g.spread;
                push -= at.N[i] * g.along[i];
            }
            r.softer = found.rest.value - found.moving;
            push += 0.5 * r.square * found.rest.value * part * r.steepening;
            push += (r.along - found.moving) * at.e * turning;
        }
        for (int j = 0; j < BELOW; j++)
            push += r.change[j] * found.K *
                    pull<false>(r.links[j].axial, g.lengths[j] + 2.0 * r.part[j] * found.K, 0.0).elastic;
        if (r.state != Touching::NO && !g.is_apart) r.push = push;
    }
};

}  // namespace RW_VARIANT
