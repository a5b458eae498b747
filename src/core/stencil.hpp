// A point of a run between its nodes: on a quintic spline through them, which is four times differentiable, so that a
// load passes nodes without an event.
//
// Control points are c = r - D2 r/4, which undoes to the fourth order of the mesh what a quintic B-spline smooths.
// Beyond an end the run is continued by its point reflection, c(-j) = 2 c(0) - c(j): the curve ends in the end node.
#pragma once

#include "arena.hpp"

namespace RW_VARIANT {

// Where a point is: in which link, and which node is the first of those that share it.
struct Cell {
    I64 links, link, first;
};

// The cell of a point at x links along a run; x beyond an end belongs to the last link there.
inline Cell locate(I64 links, double x) {
    const double last = static_cast<double>(links - 1);
    const I64 link = static_cast<I64>(x > 0.0 ? (x < last ? x : last) : 0.0);
    const I64 first = link - 3 < links + 1 - SHARED ? link - 3 : links + 1 - SHARED;
    return {links, link, first > 0 ? first : 0};
}

// A function of a place: its value, and its first two derivatives.
struct Jet {
    double value, first, second;

    Jet() = default;
    Jet(double constant) : value(constant), first(0.0), second(0.0) {}
    Jet(double a, double b, double c) : value(a), first(b), second(c) {}
};
inline Jet operator+(const Jet& x, const Jet& y) { return {x.value + y.value, x.first + y.first, x.second + y.second}; }
inline Jet operator-(const Jet& x) { return {-x.value, -x.first, -x.second}; }
inline Jet operator*(const Jet& x, double y) { return {x.value * y, x.first * y, x.second * y}; }
inline Jet operator*(const Jet& x, const Jet& y) {
    return {x.value * y.value, x.first * y.value + x.value * y.first,
            x.second * y.value + 2.0 * x.first * y.first + x.value * y.second};
}

// Quintic B-splines of the six nodes around a link at the part f of it, times 120, by powers of f.
constexpr double QUINTIC[6][6] = {{1, -5, 10, -10, 5, -1},    {26, -50, 20, 20, -20, 5}, {66, 0, -60, 0, 30, -10},
                                  {26, 50, 20, -20, -20, 10}, {1, 5, 10, 10, 5, -5},     {0, 0, 0, 0, 0, 1}};
template <class S>
inline void quintic(const S& f, S* basis) {
    for (int i = 0; i < 6; i++) {
        S sum = QUINTIC[i][5];
        for (int power = 4; power >= 0; power--) sum = sum * f + QUINTIC[i][power];
        basis[i] = sum * (1.0 / 120.0);
    }
}

// Add the control point of node j, which may be beyond an end, with a weight.
template <class S>
inline void add_control(const Cell& cell, I64 j, const S& w, S* weight) {
    const I64 n = cell.links, end = j < 0 ? 0 : n;
    if (j < 0 || j > n) {
        add_control(cell, end, w + w, weight);
        add_control(cell, 2 * end - j, -w, weight);
    } else if (j == 0 || j == n) {
        weight[j - cell.first] = weight[j - cell.first] + w;
    } else {
        for (I64 k = j - 1; k <= j + 1; k++) {
            S& at = weight[k - cell.first];
            at = at + w * (k == j ? 1.5 : -0.25);
        }
    }
}

// Quintic B-splines of sharpened control points: weights of nodes inside a run by powers of the part of a link.
struct Sharpened {
    double by_power[6][SHARED];

    constexpr Sharpened() : by_power{} {
        for (int power = 0; power < 6; power++)
            for (int i = 0; i < 6; i++)
                for (int k = 0; k < 3; k++)
                    by_power[power][i + k] += QUINTIC[i][power] * (k == 1 ? 1.5 : -0.25) / 120.0;
    }
};
constexpr Sharpened SHARPENED;

// Weights of the nodes that share the point at x links along a run, in a cell that has been located.
template <class S>
inline void weigh(const Cell& cell, const S& x, S* weight) {
    S basis[6];
    quintic(x + S(-static_cast<double>(cell.link)), basis);
    for (int k = 0; k < SHARED; k++) weight[k] = S(0.0);
    for (int i = 0; i < 6; i++) add_control(cell, cell.link - 2 + i, basis[i], weight);
}

// Weights and their first two derivatives by x.
inline void weigh(const Cell& cell, double x, double* weight, double* first, double* second) {
    if (cell.link < 3 || cell.link + 4 > cell.links) {
        Jet jets[SHARED];
        weigh(cell, Jet(x, 1.0, 0.0), jets);
        for (int k = 0; k < SHARED; k++)
            weight[k] = jets[k].value, first[k] = jets[k].first, second[k] = jets[k].second;
        return;
    }
    const double f = x - static_cast<double>(cell.link);
    for (int k = 0; k < SHARED; k++) {
        double value = SHARPENED.by_power[5][k], rate = 0.0, bent = 0.0;
        for (int power = 4; power >= 0; power--) {
            bent = bent * f + rate;
            rate = rate * f + value;
            value = value * f + SHARPENED.by_power[power][k];
        }
        weight[k] = value, first[k] = rate, second[k] = bent + bent;
    }
}

// Whether the line of a run goes on with the next one, and the first run of its line.
inline bool goes_on(const Model& m, I64 run) { return m.run_continues[run] && run + 1 < m.runs; }
inline I64 first_run_of(const Model& m, I64 run) {
    while (run > 0 && m.run_continues[run - 1]) run--;
    return run;
}

}  // namespace RW_VARIANT
