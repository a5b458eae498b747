// Sums over all elements in doubles and dual numbers, for everything but steps.
#pragma once

#include "bind.hpp"

namespace RW_VARIANT {

// Forces (axis, node) on all nodes at the positions of State and velocities (axis, node), N; weights and loads
// included.
void add_forces(const Blocks& blocks, const double* velocities, double* forces);
// Energies, J: of elements, of weights.
void sum_energies(const Blocks& blocks, double* energies);
// Of each sheave: tension before and behind it, angle, largest friction (4, sheave).
void evaluate_sheaves(const Blocks& blocks, double* values);
// Of contacts (row, contact): force on the run, N, and point of the load, m, by axes; change of all energy with the
// place, N.
void evaluate_contacts(const Blocks& blocks, double* values);
// Number of the entries of the matrices.
I64 count_entries(const Blocks& blocks);
// Entries of K and C with their rows and columns, axis * nodes + node; forces as above.
void linearise_all(const Blocks& blocks, const double* velocities, double* forces, I64* rows, I64* columns, double* K,
                   double* C);

}  // namespace RW_VARIANT
