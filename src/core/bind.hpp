// Checks of blocks before anything is computed with them.
#pragma once

#include "arena.hpp"

// What rw_bind found wrong. Numbers are those of ropewalk.engine.model.
enum class Fault : I64 {
    NONE,
    BLOCK,     // not a block of this core, of this part, or of this size: `field` is the part
    SIZES,     // the three blocks differ: `field` is the dimension
    VALUE,     // a number is not finite, or outside of what its field admits
    INDEX,     // a node that does not exist
    RUN,       // a run has no link, leaves the nodes, or begins before the one before it has ended
    JOINT,     // a copy is its own original, inside a run, a copy twice, or has mass, weight or another position
    SPRING,    // both nodes are the same
    BAND,      // a band has no spring, leaves the nodes, its sides overlap, or the band before it begins behind it
    PART,      // the first part does not begin with the first run, or a part begins before the one before it
    UNDAMPED,  // a damper in a model without predicted velocities
    TAUT,      // a node inside a taut run moves along another than the last axis
    SHEAVE,    // runs, nodes or split of a sheave are not as check_sheaves wants them
};

struct Finding {
    Fault fault;
    I64 field, entry;  // entry: number in the array, row by row
};

namespace RW_VARIANT {

struct Blocks {
    Arena model, state, work;
};

// Bytes of the block of a part.
I64 bytes_of(Part part, const I64* counts);
// Whether counts are those of a structure, and what follows from them is filled in.
bool complete(I64* counts);
// Check blocks of so many bytes, and prepare the Workspace.
Finding bind(const Blocks& blocks, const I64* bytes);
// Whether bind has checked them.
bool are_bound(const Blocks& blocks);

}  // namespace RW_VARIANT
