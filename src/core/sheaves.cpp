#include "sheaves.hpp"

#include "assembly.hpp"
#include "sheave.hpp"

namespace RW_VARIANT {

// A node passes where the piece up to it is shorter than this part of a link. It is less than half, so that a node
// which has just passed is not about to come back.
constexpr double CLOSE = 0.4;
constexpr int ROUNDS = 4;  // in which the mean velocity of a sheave is found

// Potential energy, and kinetic energy of a node and its sheave.
static double energy_with(const Model& m, const State& s, const Blocks& blocks, I64 node, I64 sheave) {
    double energies[2], kinetic = 0.0;
    sum_energies(blocks, energies);
    for (I64 row = 0; row < m.axes * m.stride; row += m.stride)
        for (int k = 0; k < 2; k++)
            if (const I64 i = row + (k ? node : sheave); m.mobility[i] > 0.0)
                kinetic += 0.5 * s.velocity[i] * s.velocity[i] / m.mobility[i];
    return energies[0] + energies[1] + kinetic;
}

// A node on its way over a sheave: the nodes that are concerned, and directions of the rope.
struct Passage {
    const Model& m;
    I64 node, sheave, beyond;
    double before[3]{}, behind[3]{};

    Passage(const Model& model, const State& s, I64 node_, I64 sheave_, I64 beyond_)
        : m(model), node(node_), sheave(sheave_), beyond(beyond_) {
        towards(s, node, sheave, before), towards(s, sheave, beyond, behind);
    }
    void towards(const State& s, I64 from, I64 to, double* way) const {
        double square = 0.0;
        for (I64 axis = 0; axis < m.axes; axis++) {
            way[axis] = s.position[axis * m.stride + to] - s.position[axis * m.stride + from];
            square += way[axis] * way[axis];
        }
        const double inverse = square > 0.0 ? 1.0 / root(square) : 0.0;
        for (I64 axis = 0; axis < m.axes; axis++) way[axis] *= inverse;
    }
    // The node keeps its speed along the rope, and has that of the straight piece beyond, at a part of it, across. Both
    // are relative to the mean velocity of the sheave, which takes the momentum that the node loses.
    void turn(const View<double>& velocity, double part) const {
        double momentum[3]{}, turned[3]{};
        for (int round = 0; round < ROUNDS; round++) {
            double along = 0.0, ahead = 0.0, base[3]{};
            for (I64 axis = 0; axis < m.axes; axis++) {
                const I64 row = axis * m.stride;
                base[axis] = velocity[row + sheave] + 0.5 * m.mobility[row + sheave] * momentum[axis];
                along += (velocity[row + node] - base[axis]) * before[axis];
                ahead += (velocity[row + beyond] - base[axis]) * behind[axis];
            }
            for (I64 axis = 0; axis < m.axes; axis++) {
                const I64 row = axis * m.stride;
                const double across = part * (velocity[row + beyond] - base[axis] - ahead * behind[axis]);
                turned[axis] = base[axis] + across + along * behind[axis];
                momentum[axis] = (velocity[row + node] - turned[axis]) / m.mobility[row + node];
            }
        }
        for (I64 axis = 0; axis < m.axes; axis++) {
            velocity[axis * m.stride + node] = turned[axis];
            velocity[axis * m.stride + sheave] += m.mobility[axis * m.stride + sheave] * momentum[axis];
        }
    }
    void move(const State& s, double part) const {
        for (I64 axis = 0; axis < m.axes; axis++) {
            double* const x = s.position.at(axis * m.stride, m.nodes);
            x[node] = x[sheave] + part * (x[beyond] - x[sheave]);
        }
    }
};

// Let the last node of a run pass on to the next one, or the first node of the next one pass back.
static void pass(const Blocks& blocks, const Model& m, const State& s, I64 q, bool on) {
    const I64 run = m.sheave_run[q], last = s.run_first[run] + s.run_links[run], way = on ? 1 : -1;
    double& split = s.position[m.sheave_split[q]];
    const double h = m.link_length[run], piece = on ? 2.0 * h - split : split, part = (piece - h) / piece;
    const I64 node = on ? last : last + 1;
    const double energy = energy_with(m, s, blocks, node, m.sheave_node[q]);
    const Passage passage(m, s, node, m.sheave_node[q], on ? last + 1 : last);
    passage.turn(s.velocity, part);
    if (m.viscous) passage.turn(s.predicted, part);
    passage.move(s, part);
    s.run_links[run] -= way, s.run_links[run + 1] += way, s.run_first[run + 1] -= way;
    split += on ? h : -h;
    s.sheave_loss[q] += energy - energy_with(m, s, blocks, node, m.sheave_node[q]);
}

I64 pass_nodes(char* const* bases) {
    const Blocks blocks{{bases[0]}, {bases[1]}, {bases[2]}};
    const Model m(blocks.model);
    const State s(blocks.state);
    I64 count = 0;
    for (I64 q = 0; q < m.sheaves; q++) {
        const I64 run = m.sheave_run[q];
        const double links = s.position[m.sheave_split[q]] / m.link_length[run];
        if (links >= CLOSE && links <= 2.0 - CLOSE) continue;
        const bool on = links < CLOSE;
        if (s.run_links[on ? run : run + 1] < 2) return -1;
        pass(blocks, m, s, q, on);
        count++;
    }
    return count;
}

}  // namespace RW_VARIANT
